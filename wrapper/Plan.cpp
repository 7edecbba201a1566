//===- Plan.cpp -----------------------------------------------------------===//
#include "Plan.h"

#include <algorithm>
#include <string_view>

namespace fs = std::filesystem;

namespace tpc {

static bool startsWith(std::string_view Text, std::string_view Start) {
  return Text.substr(0, Start.size()) == Start;
}

std::string linkUnitName(const std::string &Output) {
  std::string Name = fs::path(Output).filename();
  const size_t Suffix = Name.find(".so");
  const bool IsLibrary = Suffix != Name.npos && Suffix > 0 &&
                         (Suffix + 3 == Name.size() || Name[Suffix + 3] == '.');
  if (!IsLibrary)
    return Name;
  Name.resize(Suffix);
  return startsWith(Name, "lib") && Name.size() > 3 ? Name.substr(3) : Name;
}

/// File names of the checks of Autoconf, CMake and Meson.
static bool isProbeName(const std::string &Name) {
  for (std::string_view Start :
       {"conftest", "cmTC_", "cmTryCompileExec", "testCCompiler",
        "testCXXCompiler", "CMakeCCompilerId", "CMakeCXXCompilerId",
        "sanitycheckc"})
    if (startsWith(Name, Start))
      return true;
  return false;
}

/// Folders in which CMake, Meson, SCons, waf and qmake run checks.
static bool isProbeFolder(const fs::path &Folder) {
  return std::any_of(Folder.begin(), Folder.end(), [](const fs::path &Part) {
    const std::string Name = Part;
    return Name == "CMakeTmp" || Name == "CMakeScratch" ||
           Name == "CompilerIdC" || Name == "CompilerIdCXX" ||
           Name == "meson-private" || Name == ".sconf_temp" ||
           Name == "config.tests" || startsWith(Name, ".conf_check_");
  });
}

bool isProbe(const Arguments &Asked, const fs::path &Folder) {
  if (Asked.AsksLinker || isProbeFolder(Folder))
    return true;
  auto IsOfProbe = [](const fs::path &Path) {
    return Path == "/dev/null" || isProbeName(Path.filename()) ||
           isProbeFolder(Path.parent_path());
  };
  // A library in the folder of a check is not one of the program's own sources.
  return IsOfProbe(Asked.Output) ||
         std::any_of(Asked.Inputs.begin(), Asked.Inputs.end(),
                     [&](const Input &I) {
                       return I.Path == "-" || IsOfProbe(I.Path);
                     });
}

/// Each word gets its own -Xlinker, because -Wl, would split a path at its
/// commas.
static void addForLinker(std::vector<std::string> &To,
                         const std::vector<std::string> &Words) {
  for (const std::string &Word : Words) {
    To.push_back("-Xlinker");
    To.push_back(Word);
  }
}

static void add(std::vector<std::string> &To,
                const std::vector<std::string> &Words) {
  To.insert(To.end(), Words.begin(), Words.end());
}

static std::vector<std::string> passOptions(const Environment &Around,
                                            const std::string &Output) {
  const fs::path File = (Around.WorkingFolder / Output).lexically_normal();
  const std::string Unit = linkUnitName(File);
  const fs::path Folder =
      Around.StaticInfo.empty() ? File.parent_path() : Around.StaticInfo;
  std::vector<std::string> Options = {
      "-tpc-link-unit=" + Unit, "-tpc-package=" + Around.Package,
      "-tpc-source-root=" + Around.SourceRoot.string(),
      "-tpc-static-info=" + (Folder / "tpc" / (Unit + ".json")).string(),
      "-tpc-manifest=" + (Folder / "tpc" / (Unit + ".link.json")).string()};
  if (!Around.Profile.empty())
    Options.push_back("-tpc-profile=" + Around.Profile);
  if (!Around.MaxSeconds.empty())
    Options.push_back("-tpc-max-seconds=" + Around.MaxSeconds);
  if (!Around.MaxMemory.empty())
    Options.push_back("-tpc-max-memory=" + Around.MaxMemory);
  if (!Around.Rules.empty())
    Options.push_back("-tpc-rules=" + Around.Rules);
  if (Around.Constants)
    Options.push_back("-tpc-constants");
  return Options;
}

static void addPassOptions(std::vector<std::string> &To,
                           const std::vector<std::string> &Options) {
  for (const std::string &Option : Options)
    addForLinker(To, {"-mllvm", Option});
}

/// Why a link gets no reports although the flags of its objects allow it: the
/// log library is a shared one, and the object of a relocatable link may become
/// part of any program.
static std::string whyNoReports(const Arguments &Asked) {
  if (Asked.IsStatic)
    return "a static program cannot use the log library";
  return Asked.IsRelocatable ? "the output of -r is linked again" : "";
}

Plan planFor(const Arguments &Asked, const Environment &Around) {
  Plan Out;
  if (Asked.Goal == Step::Answer)
    return Out;
  const std::string Output = Asked.Output.empty() ? "a.out" : Asked.Output;
  const bool Probe = isProbe(Asked, Around.WorkingFolder);
  const bool Links = Asked.Goal == Step::Link;
  std::string Why = Around.Missing;
  if (Why.empty() && !Asked.Obstacle.empty())
    Why = Asked.Obstacle + " cannot be combined with TPC";
  const bool IsPlain = Probe || Around.IsDisabled || !Why.empty() ||
                       Asked.hasSource(Language::Other);
  if (!IsPlain && Links)
    Why = whyNoReports(Asked);
  if (Links && !Probe && !Around.IsDisabled && !Why.empty())
    Out.Warning = linkUnitName(Output) + " is linked without reports: " + Why;
  const bool CompilesForUs =
      !IsPlain && Asked.hasSource(Language::CFamily) && (!Links || Why.empty());
  if (Asked.hasSource(Language::CFamily))
    add(Out.Added, Around.Added.Accept);
  // With -Werror, a flag that clang does not need would make every check fail;
  // and flags for C and C++ are of no use for assembler sources, about which
  // gcc does not warn.
  const bool IsAssembler = Asked.hasSource(Language::Assembler);
  if (Probe || IsAssembler)
    Out.Added.push_back("-Qunused-arguments");
  if (IsAssembler)
    Out.Added.push_back("-Wno-error");
  if (CompilesForUs) {
    add(Out.Added, Around.Added.Compile);
    // Otherwise native code beside the bitcode would be linked.
    Out.Dropped.push_back("-ffat-lto-objects");
  }
  if (!Links || Around.Lld.empty())
    return Out;
  // -flto would make bitcode of sources that must be compiled as before.
  for (const std::string &Flag : Around.Added.Link)
    if (CompilesForUs || !startsWith(Flag, "-flto"))
      Out.Added.push_back(Flag);
  if (IsPlain)
    return Out;
  addForLinker(Out.Added, Around.Added.Linker);
  if (!Why.empty()) {
    // The passes then only run the optimisation that the compiler left to them.
    addPassOptions(Out.Added, {"-tpc-analyse=false"});
    return Out;
  }
  addPassOptions(Out.Added, passOptions(Around, Output));
  addForLinker(Out.First, Around.Added.Log);
  addForLinker(Out.Added, Around.Added.Last);
  return Out;
}

} // namespace tpc
