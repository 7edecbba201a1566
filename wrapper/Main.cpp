//===- Main.cpp - tpc-clang, tpc-clang++ and LLVM's archiver --------------===//
//
// A compiler for builds without CMake: finds out what clang is asked to do,
// adds the flags of TPC and becomes clang. Under its other names it is the
// archiver that reads bitcode.
//
//===----------------------------------------------------------------------===//
#include "Plan.h"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <unistd.h>

namespace fs = std::filesystem;
using namespace tpc;

static void say(const char *What, const std::string &Text) {
  std::fprintf(stderr, "tpc: %s: %s\n", What, Text.c_str());
}

/// Becomes \p Program; if that fails, returns the exit status that a shell
/// would.
static int become(const std::string &Program, std::vector<std::string> Words) {
  std::vector<char *> Pointers;
  Words.insert(Words.begin(), Program);
  Pointers.reserve(Words.size() + 1);
  for (std::string &Word : Words)
    Pointers.push_back(Word.data());
  Pointers.push_back(nullptr);
  execv(Program.c_str(), Pointers.data());
  say("error", Program + ": " + std::strerror(errno));
  return errno == ENOENT ? 127 : 126;
}

/// Runs the archiver or a related tool; their flags stay unchanged.
static int runTool(const std::string &Tool, const fs::path &Self,
                   const std::vector<std::string> &Words) {
  const std::string Name = "llvm-" + Tool + "-" + clangVersion();
  const std::string Program = findProgram(Name, Self);
  if (!Program.empty())
    return become(Program, Words);
  say("error", Name + " is not installed (apt-get install llvm-" +
                   clangVersion() + "); the system's " + Tool +
                   " cannot read bitcode");
  return 127;
}

static int runCompiler(bool IsCxx, const fs::path &Self,
                       std::vector<std::string> Words) {
  const std::string Name =
      std::string(IsCxx ? "clang++-" : "clang-") + clangVersion();
  const std::string Program = findProgram(Name, Self);
  if (Program.empty()) {
    const std::string Other = findProgram(IsCxx ? "c++" : "cc", Self);
    const std::string Mend = Name +
                             " is not installed (apt-get install clang-" +
                             clangVersion() + ")";
    if (Other.empty()) {
      say("error", Mend);
      return 127;
    }
    say("warning", Mend + "; using " + Other + " without TPC");
    return become(Other, std::move(Words));
  }
  const Arguments Asked = parseArguments(Words);
  if (Asked.Goal == Step::Answer)
    return become(Program, std::move(Words));
  const Environment Around = Environment::read(Self);
  Plan Out = planFor(Asked, Around);
  if (!Out.Warning.empty()) {
    say("warning", Out.Warning);
  } else if (Asked.Goal == Step::Link && !Around.IsDisabled) {
    for (const std::string &Complaint : Around.Complaints)
      say("warning", Complaint);
  }
  Words.insert(Words.begin() + static_cast<std::ptrdiff_t>(Asked.End),
               Out.Added.begin(), Out.Added.end());
  for (const std::string &Flag : Out.Dropped)
    Words.erase(std::remove(Words.begin(), Words.end(), Flag), Words.end());
  Words.insert(Words.begin(), Out.First.begin(), Out.First.end());
  return become(Program, std::move(Words));
}

int main(int Count, char **Values) {
  std::error_code Failed;
  const fs::path Self = fs::read_symlink("/proc/self/exe", Failed);
  if (Failed || Count < 1) {
    say("error", "cannot read /proc/self/exe: " + Failed.message());
    return 127;
  }
  const std::string Name = fs::path(Values[0]).filename();
  std::vector<std::string> Words(Values + 1, Values + Count);
  for (const char *Tool : {"ar", "ranlib", "nm"})
    if (Name == std::string("tpc-") + Tool ||
        Name == std::string("llvm-") + Tool)
      return runTool(Tool, Self, Words);
  const bool IsCxx = Name.size() > 2 && Name.substr(Name.size() - 2) == "++";
  return runCompiler(IsCxx, Self, std::move(Words));
}
