//===- Main.cpp - tpc-relink ----------------------------------------------===//
//
// Goes before a command that links a unit with the passes:
//
//   tpc-relink clang++ ... -o PROGRAM
//
// Build tools link a program again when a shared library of it is newer. With
// link-time optimisation that takes as long as the first link, and changes
// nothing as long as the interface of the library stays (see Interface.h). Such
// a link is left out, and what it would have written gets a new time.
//
//===----------------------------------------------------------------------===//
#include "relink/LinkState.h"

#include "llvm/Support/Errno.h"
#include "llvm/Support/FileSystem.h"
#include "llvm/Support/InitLLVM.h"
#include "llvm/Support/WithColor.h"
#include "llvm/Support/raw_ostream.h"

#include <chrono>
#include <csignal>
#include <sys/wait.h>
#include <unistd.h>

using namespace llvm;
using namespace tpc;

static constexpr char Usage[] =
    "usage: tpc-relink COMMAND...\n\n"
    "Runs a command that links with the passes of TPC, unless its result would "
    "be the\nsame as that of the last run. Any other command is just run.\n";

/// Becomes \p Words; only returns if that is not possible.
static int become(ArrayRef<std::string> Words) {
  std::vector<char *> Arguments;
  for (const std::string &Word : Words)
    Arguments.push_back(const_cast<char *>(Word.c_str()));
  Arguments.push_back(nullptr);
  execvp(Arguments.front(), Arguments.data());
  const std::string Why = sys::StrError();
  WithColor::error(errs(), "tpc-relink")
      << Words.front() << ": " << Why << '\n';
  return 127;
}

/// The exit status of \p Words; a signal that ends it ends this program too.
static int runCommand(ArrayRef<std::string> Words) {
  pid_t Child = fork();
  if (Child <= 0)
    return Child < 0 ? become(Words) : (_exit(become(Words)), 0);
  int Status = 0;
  while (waitpid(Child, &Status, 0) < 0)
    if (errno != EINTR)
      return 1;
  if (WIFSIGNALED(Status)) {
    signal(WTERMSIG(Status), SIG_DFL);
    raise(WTERMSIG(Status));
  }
  return WIFEXITED(Status) ? WEXITSTATUS(Status) : 1;
}

/// Gives \p Path the time \p Now; false if that is not possible.
static bool touch(const std::string &Path, sys::TimePoint<> Now) {
  int File;
  if (sys::fs::openFileForReadWrite(Path, File, sys::fs::CD_OpenExisting,
                                    sys::fs::OF_None))
    return false;
  bool IsDone = !sys::fs::setLastAccessAndModificationTime(File, Now);
  close(File);
  return IsDone;
}

int main(int Argc, char **Argv) {
  InitLLVM X(Argc, Argv);
  if (Argc < 2 || StringRef(Argv[1]) == "--help") {
    (Argc < 2 ? errs() : outs()) << Usage;
    return Argc < 2;
  }
  LinkCommandLine Command =
      readCommand(std::vector<std::string>(Argv + 1, Argv + Argc));
  if (!Command.isKnown())
    return become(Command.Words);
  std::vector<std::string> Words = Command.Words;
  if (Command.Dependencies.empty()) {
    Command.Dependencies = Command.Manifest + ".d";
    Words.push_back("-Wl,--dependency-file=" + Command.Dependencies);
  }
  // What changes meanwhile must be newer.
  const sys::TimePoint<> Start = std::chrono::system_clock::now();
  // The output is last: it is not older than what describes it.
  if (isUpToDate(Command) && touch(Command.StaticInfo, Start) &&
      touch(Command.Manifest, Start) && touch(Command.Output, Start))
    return 0;
  sys::fs::remove(Command.stateFile());
  int Status = runCommand(Words);
  if (Status == 0)
    recordState(Command, Start);
  return Status;
}
