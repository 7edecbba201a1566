//===- CommandLine.cpp ----------------------------------------------------===//
#include "plan/CommandLine.h"

#include "llvm/ADT/STLExtras.h"
#include "llvm/ADT/SmallVector.h"
#include "llvm/ADT/StringSet.h"
#include "llvm/Support/CommandLine.h"
#include "llvm/Support/MemoryBuffer.h"
#include "llvm/Support/StringSaver.h"

using namespace llvm;

namespace tpc {

std::vector<std::string> ownCommandLine() {
  auto Buffer = MemoryBuffer::getFileAsStream("/proc/self/cmdline");
  if (!Buffer)
    return {};
  SmallVector<StringRef, 64> Words;
  StringRef All = (*Buffer)->getBuffer();
  All.consume_back(StringRef("\0", 1));
  All.split(Words, '\0');
  BumpPtrAllocator Memory;
  StringSaver Saver(Memory);
  SmallVector<const char *, 256> Expanded;
  for (StringRef Word : Words)
    Expanded.push_back(Saver.save(Word).data());
  cl::ExpandResponseFiles(Saver, cl::TokenizeGNUCommandLine, Expanded);
  return {Expanded.begin(), Expanded.end()};
}

/// The options whose value is the next word, without their dashes. Those that
/// are not in this list have their value behind `=` or have none.
static bool takesNext(StringRef Option) {
  static const StringSet<> All = {"F",
                                  "I",
                                  "L",
                                  "Map",
                                  "O",
                                  "R",
                                  "T",
                                  "Tbss",
                                  "Tdata",
                                  "Ttext",
                                  "auxiliary",
                                  "b",
                                  "call-graph-ordering-file",
                                  "chroot",
                                  "compress-debug-sections",
                                  "dT",
                                  "default-script",
                                  "defsym",
                                  "dependency-file",
                                  "dynamic-linker",
                                  "dynamic-list",
                                  "e",
                                  "entry",
                                  "error-handling-script",
                                  "error-limit",
                                  "exclude-libs",
                                  "export-dynamic-symbol",
                                  "export-dynamic-symbol-list",
                                  "f",
                                  "filter",
                                  "fini",
                                  "format",
                                  "h",
                                  "hash-style",
                                  "image-base",
                                  "init",
                                  "just-symbols",
                                  "keep-unique",
                                  "l",
                                  "library",
                                  "library-path",
                                  "load-pass-plugin",
                                  "m",
                                  "mllvm",
                                  "o",
                                  "opt-remarks-filename",
                                  "opt-remarks-format",
                                  "opt-remarks-passes",
                                  "orphan-handling",
                                  "out-implib",
                                  "output",
                                  "pack-dyn-relocs",
                                  "plugin",
                                  "print-archive-stats",
                                  "print-symbol-order",
                                  "reproduce",
                                  "retain-symbols-file",
                                  "rpath",
                                  "rpath-link",
                                  "rsp-quoting",
                                  "script",
                                  "section-start",
                                  "soname",
                                  "sort-section",
                                  "symbol-ordering-file",
                                  "threads",
                                  "trace-symbol",
                                  "u",
                                  "undefined",
                                  "undefined-glob",
                                  "unresolved-symbols",
                                  "version-script",
                                  "warn-backrefs-exclude",
                                  "why-extract",
                                  "wrap",
                                  "y",
                                  "z"};
  return All.contains(Option);
}

/// True for the likes of `-lm`, with the value in the same word.
static bool isJoined(StringRef Option) {
  static constexpr StringLiteral Longer[] = {"lto-", "omagic", "opt-remarks-",
                                             "oformat", "help"};
  return StringRef("lLohR").contains(Option.front()) &&
         none_of(Longer, [&](StringRef L) { return Option.starts_with(L); });
}

namespace {

/// What the options before a file say of it.
struct State {
  LinkInput Now;
  std::vector<LinkInput> Pushed;

  /// Changes as \p Option, which takes no value, says; false if it says nothing
  /// of files.
  bool change(StringRef Option) {
    if (Option == "whole-archive" || Option == "no-whole-archive")
      Now.WholeArchive = Option == "whole-archive";
    else if (Option == "as-needed" || Option == "no-as-needed")
      Now.AsNeeded = Option == "as-needed";
    else if (Option == "Bstatic" || Option == "dn" || Option == "non_shared" ||
             Option == "static")
      Now.Static = true;
    else if (Option == "Bdynamic" || Option == "dy" || Option == "call_shared")
      Now.Static = false;
    else if (Option == "start-lib" || Option == "end-lib")
      Now.Lazy = Option == "start-lib";
    else if (Option == "push-state")
      Pushed.push_back(Now);
    else if (Option == "pop-state" && !Pushed.empty()) {
      Now = Pushed.back();
      Pushed.pop_back();
    } else
      return false;
    return true;
  }
  LinkInput at(StringRef Name, bool IsLibrary) const {
    LinkInput In = Now;
    In.Name = Name.str();
    In.IsLibrary = IsLibrary;
    return In;
  }
};

} // namespace

/// Stores \p Value of \p Option, if the option is one of those that matter.
static void store(LinkCommand &To, const State &Files, StringRef Option,
                  StringRef Value) {
  if (Option == "o" || Option == "output")
    To.Output = Value.str();
  else if (Option == "soname" || Option == "h")
    To.SoName = Value.str();
  else if (Option == "rpath" || Option == "R")
    To.RunPaths.push_back(Value.str());
  else if (Option == "L" || Option == "library-path")
    To.LibraryFolders.push_back(Value.str());
  else if (Option == "l" || Option == "library")
    To.Inputs.push_back(Files.at(Value, /*IsLibrary=*/true));
}

LinkCommand readLinkCommand(ArrayRef<std::string> Words) {
  LinkCommand To;
  State Files;
  for (size_t N = 0; N < Words.size(); ++N) {
    StringRef Word = Words[N];
    if (Word.size() < 2 || !Word.starts_with("-")) {
      To.Inputs.push_back(Files.at(Word, /*IsLibrary=*/false));
      continue;
    }
    StringRef Option = Word.drop_front(Word.starts_with("--") ? 2 : 1);
    if (Option == "shared" || Option == "Bshareable")
      To.IsShared = true;
    if (Files.change(Option))
      continue;
    if (takesNext(Option)) {
      if (N + 1 < Words.size())
        store(To, Files, Option, Words[++N]);
    } else if (auto [Name, Value] = Option.split('=');
               !Value.empty() && takesNext(Name)) {
      store(To, Files, Name, Value);
    } else if (!Word.starts_with("--") && isJoined(Option)) {
      store(To, Files, Option.take_front(1), Option.drop_front(1));
    }
  }
  return To;
}

} // namespace tpc
