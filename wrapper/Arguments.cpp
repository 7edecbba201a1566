//===- Arguments.cpp ------------------------------------------------------===//
#include "Arguments.h"

#include <algorithm>
#include <cctype>
#include <fstream>
#include <initializer_list>
#include <iterator>
#include <string_view>
#include <sys/utsname.h>

namespace tpc {

static bool startsWith(std::string_view Text, std::string_view Start) {
  return Text.substr(0, Start.size()) == Start;
}

static bool isOneOf(std::string_view Text,
                    std::initializer_list<std::string_view> Names) {
  return std::find(Names.begin(), Names.end(), Text) != Names.end();
}

bool Arguments::hasSource(Language Kind) const {
  return std::any_of(Inputs.begin(), Inputs.end(),
                     [&](const Input &I) { return I.Kind == Kind; });
}

/// Flags whose value is the next argument. Includes the separate form of flags
/// that also accept a joined value.
static bool takesNext(std::string_view Flag) {
  return isOneOf(Flag, {"-o",
                        "--output",
                        "-x",
                        "--language",
                        "-I",
                        "-D",
                        "-U",
                        "-L",
                        "-l",
                        "-F",
                        "-B",
                        "-T",
                        "-u",
                        "-e",
                        "-z",
                        "-A",
                        "-G",
                        "-MF",
                        "-MT",
                        "-MQ",
                        "-MJ",
                        "-include",
                        "-imacros",
                        "-isystem",
                        "-iquote",
                        "-idirafter",
                        "-iprefix",
                        "-iwithprefix",
                        "-iwithprefixbefore",
                        "-iwithsysroot",
                        "-isysroot",
                        "-iframework",
                        "-iframeworkwithsysroot",
                        "-include-pch",
                        "-ivfsoverlay",
                        "-cxx-isystem",
                        "-stdlib++-isystem",
                        "--sysroot",
                        "--include",
                        "--imacros",
                        "--include-directory",
                        "--library-directory",
                        "--define-macro",
                        "--undefine-macro",
                        "--param",
                        "--prefix",
                        "-Xlinker",
                        "--for-linker",
                        "-Xclang",
                        "-Xpreprocessor",
                        "-Xassembler",
                        "-Xanalyzer",
                        "-Xopenmp-target",
                        "-Xcuda-fatbinary",
                        "-Xcuda-ptxas",
                        "-mllvm",
                        "-target",
                        "-arch",
                        "-framework",
                        "-rpath",
                        "-dumpdir",
                        "-aux-info",
                        "-working-directory",
                        "-gcc-toolchain",
                        "--serialize-diagnostics",
                        "-serialize-diagnostics",
                        "-fmodule-name",
                        "--config",
                        "-install_name",
                        "-undefined",
                        "-segprot",
                        "-mthread-model",
                        "-Xflang",
                        "-filelist",
                        "-specs",
                        "--specs"});
}

/// Flags that produce no object: those of the preprocessor, questions, and
/// those that ask for something else than code.
static bool asksForNoObject(std::string_view Flag) {
  return isOneOf(Flag, {"-E",
                        "--preprocess",
                        "-S",
                        "--assemble",
                        "-M",
                        "-MM",
                        "--dependencies",
                        "--user-dependencies",
                        "-fsyntax-only",
                        "-emit-llvm",
                        "-emit-ast",
                        "--analyze",
                        "--precompile",
                        "-extract-api",
                        "-emit-interface-stubs",
                        "-rewrite-objc",
                        "-module-file-info",
                        "-verify-pch",
                        "--version",
                        "--help",
                        "-help",
                        "-dumpversion",
                        "-dumpmachine",
                        "-dumpspecs",
                        "--autocomplete",
                        "-cc1",
                        "-cc1as"}) ||
         startsWith(Flag, "-print-") || startsWith(Flag, "--print-") ||
         startsWith(Flag, "--help-") || startsWith(Flag, "--autocomplete=");
}

static Language languageOf(std::string_view Name) {
  if (isOneOf(Name, {"c", "c++", "objective-c", "objective-c++", "c-header",
                     "c++-header", "c++-user-header", "c++-system-header",
                     "cpp-output", "c++-cpp-output", "c++-module",
                     "objective-c-header", "objective-c++-header"}))
    return Language::CFamily;
  if (isOneOf(Name, {"assembler", "assembler-with-cpp"}))
    return Language::Assembler;
  return Language::Other;
}

/// True if clang makes a precompiled header from the input, and links nothing.
static bool isHeader(std::string_view Forced, std::string_view Path) {
  if (!Forced.empty())
    return Forced.find("header") != Forced.npos;
  const size_t Dot = Path.rfind('.');
  return Dot != Path.npos &&
         isOneOf(Path.substr(Dot + 1),
                 {"h", "H", "hh", "hp", "hpp", "hxx", "h++"});
}

static Language languageOfFile(std::string_view Path) {
  if (Path == "-")
    return Language::CFamily;
  const size_t Slash = Path.rfind('/');
  const size_t Dot = Path.rfind('.');
  if (Dot == Path.npos || (Slash != Path.npos && Dot < Slash))
    return Language::None;
  const std::string_view Suffix = Path.substr(Dot + 1);
  if (isOneOf(Suffix,
              {"c",    "i",   "C",    "cc",   "cp",  "cpp", "cxx", "c++",
               "CPP",  "CXX", "ii",   "m",    "mi",  "M",   "mm",  "mii",
               "h",    "H",   "hh",   "hp",   "hpp", "hxx", "h++", "ixx",
               "cppm", "ccm", "cxxm", "c++m", "iim"}))
    return Language::CFamily;
  if (isOneOf(Suffix, {"s", "S", "sx", "asm"}))
    return Language::Assembler;
  if (isOneOf(Suffix,
              {"f",   "F",    "for", "FOR",   "fpp", "FPP", "f90", "F90",
               "f95", "F95",  "f03", "F03",   "f08", "F08", "cu",  "cui",
               "hip", "hipi", "cl",  "clcpp", "ll",  "bc",  "ast", "pcm",
               "rs",  "ads",  "adb", "d",     "go",  "ifs"}))
    return Language::Other;
  return Language::None;
}

/// True if code for \p Triple is for another machine: the log library can only
/// be part of programs of this one.
static bool isForeign(std::string_view Triple) {
  utsname Here;
  if (uname(&Here) != 0)
    return false;
  const std::string_view Machine = Triple.substr(0, Triple.find('-'));
  return Machine != Here.machine || Triple.find("linux") == Triple.npos ||
         Triple.find("gnux32") != Triple.npos ||
         Triple.find("musl") != Triple.npos ||
         Triple.find("android") != Triple.npos;
}

/// True if \p Flag makes clang instrument the code itself, in passes that TPC
/// postpones (tpc.cmake has the same list), or if the code is for another
/// machine or for none.
static bool isObstacle(std::string_view Flag) {
  if (startsWith(Flag, "-fsanitize=") || startsWith(Flag, "-fprofile-") ||
      isOneOf(Flag, {"--coverage", "-coverage", "-ftest-coverage",
                     "-fcoverage-mapping", "-m32", "-mx32", "-m16",
                     "-fmodule-header", "-fsycl"}))
    return true;
  constexpr std::string_view Target = "--target=";
  return startsWith(Flag, Target) && isForeign(Flag.substr(Target.size()));
}

/// The words of a response file: white space separates them, quotes keep white
/// space, and a backslash keeps the next character.
static std::vector<std::string> responseWords(const std::string &Text) {
  std::vector<std::string> Words;
  std::string Word;
  bool IsOpen = false;
  char Quote = 0;
  for (size_t I = 0; I < Text.size(); ++I) {
    const char C = Text[I];
    const bool IsSpace = std::isspace(static_cast<unsigned char>(C)) != 0;
    if (C == '\\' && I + 1 < Text.size()) {
      Word += Text[++I];
      IsOpen = true;
    } else if (Quote != 0 && C == Quote) {
      Quote = 0;
    } else if (Quote == 0 && (C == '"' || C == '\'')) {
      Quote = C;
      IsOpen = true;
    } else if (Quote != 0 || !IsSpace) {
      Word += C;
      IsOpen = true;
    } else if (IsOpen) {
      Words.push_back(std::move(Word));
      Word.clear();
      IsOpen = false;
    }
  }
  if (IsOpen)
    Words.push_back(std::move(Word));
  return Words;
}

namespace {
/// A word of the command line, and the number of the argument that contained
/// it.
struct Word {
  std::string Text;
  size_t Argument;
};

/// Response files may name other ones; this limits cycles.
constexpr unsigned MaxDepth = 16;

class Parser {
public:
  explicit Parser(const std::vector<std::string> &Given) {
    Found.End = Given.size();
    for (size_t I = 0; I < Given.size(); ++I)
      expand(Given[I], I, 0);
  }

  Arguments run() {
    while (At < Words.size())
      one(Words[At++]);
    const bool HasInput = !Found.Inputs.empty() || HasLinkerInput;
    Found.AsksLinker &= !HasInput;
    if (IsQuestion || !(HasInput || Found.AsksLinker))
      Found.Goal = Step::Answer;
    else if (CompilesOnly || (HasOnlyHeaders && !Found.Inputs.empty()))
      Found.Goal = Step::Compile;
    else
      Found.Goal = Step::Link;
    return std::move(Found);
  }

private:
  void expand(const std::string &Text, size_t Argument, unsigned Depth) {
    if (Text.size() > 1 && Text[0] == '@' && Depth < MaxDepth) {
      std::ifstream Stream(Text.substr(1), std::ios::binary);
      // If the file does not exist, clang takes it for an ordinary argument
      // too.
      if (Stream) {
        const std::string Read{std::istreambuf_iterator<char>(Stream), {}};
        for (const std::string &Inner : responseWords(Read))
          expand(Inner, Argument, Depth + 1);
        return;
      }
    }
    Words.push_back({Text, Argument});
  }

  std::string next() { return At < Words.size() ? Words[At++].Text : ""; }

  void one(const Word &Current) {
    const std::string &Text = Current.Text;
    if (IsBehindFlags || Text == "-" || Text.empty() || Text[0] != '-')
      return input(Text);
    if (Text == "--") {
      IsBehindFlags = true;
      Found.End = Current.Argument;
      return;
    }
    if (takesNext(Text))
      return pair(Text, next());
    flag(Text);
  }

  void input(const std::string &Path) {
    HasOnlyHeaders &= isHeader(Forced, Path);
    Found.Inputs.push_back(
        {Path, Forced.empty() ? languageOfFile(Path) : languageOf(Forced)});
  }

  void pair(const std::string &Flag, const std::string &Value) {
    if (Flag == "-o" || Flag == "--output")
      Found.Output = Value;
    else if (Flag == "-x" || Flag == "--language")
      Forced = Value == "none" ? "" : Value;
    else if (Flag == "-l")
      HasLinkerInput = true;
    else if (Flag == "-Xlinker" || Flag == "--for-linker")
      linkerFlag(Value);
    else if (Flag == "-target" && isForeign(Value))
      obstacle("-target " + Value);
  }

  void flag(const std::string &Text) {
    if (asksForNoObject(Text))
      IsQuestion = true;
    else if (isObstacle(Text))
      obstacle(Text);
    else if (Text == "-c" || Text == "--compile")
      CompilesOnly = true;
    else if (Text == "-static" || Text == "--static" || Text == "-static-pie")
      Found.IsStatic = true;
    else if (Text == "-r")
      Found.IsRelocatable = true;
    else if (startsWith(Text, "--output="))
      Found.Output = Text.substr(9);
    else if (startsWith(Text, "-o") && !startsWith(Text, "-obj"))
      Found.Output = Text.substr(2);
    else if (startsWith(Text, "-x"))
      Forced = Text == "-xnone" ? "" : Text.substr(2);
    else if (startsWith(Text, "-l"))
      HasLinkerInput = true;
    else if (startsWith(Text, "-Wl,"))
      linkerFlags(Text.substr(4));
  }

  void linkerFlags(const std::string &Joined) {
    size_t Start = 0;
    for (size_t Comma; (Comma = Joined.find(',', Start)) != Joined.npos;
         Start = Comma + 1)
      linkerFlag(Joined.substr(Start, Comma - Start));
    linkerFlag(Joined.substr(Start));
  }

  void linkerFlag(std::string_view Flag) {
    Found.AsksLinker |= isOneOf(Flag, {"--version", "-v", "-V", "--help"});
    Found.IsRelocatable |= isOneOf(Flag, {"-r", "--relocatable"});
  }

  void obstacle(std::string Flag) {
    if (Found.Obstacle.empty())
      Found.Obstacle = std::move(Flag);
  }

  Arguments Found;
  std::vector<Word> Words;
  size_t At = 0;
  std::string Forced; ///< the language of -x
  bool IsBehindFlags = false;
  bool IsQuestion = false;
  bool CompilesOnly = false;
  bool HasOnlyHeaders = true;
  bool HasLinkerInput = false;
};
} // namespace

Arguments parseArguments(const std::vector<std::string> &Words) {
  return Parser(Words).run();
}

} // namespace tpc
