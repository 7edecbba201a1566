//===- Options.cpp --------------------------------------------------------===//
#include "Options.h"

#include "plan/CommandLine.h"
#include "plan/PlansFolder.h"

#include "llvm/ADT/SmallString.h"
#include "llvm/ADT/StringExtras.h"
#include "llvm/IR/Function.h"
#include "llvm/Support/CommandLine.h"
#include "llvm/Support/FileSystem.h"
#include "llvm/Support/Path.h"
#include "llvm/Support/WithColor.h"

using namespace llvm;

namespace tpc {

static cl::OptionCategory Category("Threshold predicate comparisons");

static cl::opt<std::string>
    LinkUnitOpt("tpc-link-unit", cl::cat(Category),
                cl::desc("Name of the link unit (default: the output's)"));
static cl::opt<std::string> PackageOpt("tpc-package", cl::cat(Category),
                                       cl::desc("Name of the package"));
static cl::opt<std::string>
    SourceRootOpt("tpc-source-root", cl::cat(Category),
                  cl::desc("Folder that reported files are relative to"));
static cl::opt<std::string>
    StaticInfoOpt("tpc-static-info", cl::cat(Category),
                  cl::desc("File for the static information (JSON)"));
static cl::opt<std::string>
    ProfileOpt("tpc-profile", cl::cat(Category), cl::init("default"),
               cl::desc("Profile of the rules: thesis or default"));
static cl::list<std::string>
    RulesOpt("tpc-rules", cl::cat(Category),
             cl::desc("A further file of rules (JSON); may be repeated"));
static cl::list<std::string>
    ExcludeOpt("tpc-exclude", cl::cat(Category),
               cl::desc("A folder whose code is not reported on; may be "
                        "repeated. /usr and /opt/ros are always excluded"));
static cl::opt<bool> AnalyseOpt(
    "tpc-analyse", cl::cat(Category), cl::init(true),
    cl::desc("Analyse the link unit. If not, only run the "
             "optimisation that was left to the link (default: yes)"));
static cl::opt<bool>
    InstrumentOpt("tpc-instrument", cl::cat(Category), cl::init(true),
                  cl::desc("Insert the reports (default: yes)"));
static cl::opt<bool>
    ConstantsOpt("tpc-constants", cl::cat(Category),
                 cl::desc("Also report comparisons with constants"));
static cl::opt<bool>
    PrelinkOpt("tpc-prelink", cl::cat(Category), cl::init(true),
               cl::desc("Run the optimisation that was left to the link "
                        "(default: yes)"));
static cl::opt<std::string>
    ManifestOpt("tpc-manifest", cl::cat(Category),
                cl::desc("File for what this link needs, so that another link "
                         "can repeat it (JSON)"));
static cl::opt<std::string>
    PlanOutOpt("tpc-plan-out", cl::cat(Category),
               cl::desc("File for the findings, which -tpc-plan inserts in "
                        "another link (JSON)"));
static cl::list<std::string>
    PlanOpt("tpc-plan", cl::cat(Category),
            cl::desc("Insert the findings of this file, without an analysis; "
                     "may be repeated"));
static cl::opt<unsigned> MaxSecondsOpt(
    "tpc-max-seconds", cl::cat(Category), cl::init(120),
    cl::desc("Limit of the analysis in seconds of processor time (default: "
             "120; 0: no limit); beyond it the link unit is not changed"));
static cl::opt<unsigned> MaxMemoryOpt(
    "tpc-max-memory", cl::cat(Category), cl::init(4096),
    cl::desc("Limit of the analysis in MiB of memory (default: 4096; 0: no "
             "limit); beyond it the link unit is not changed"));
static cl::ValuesClass failureKinds() {
  return cl::values(
      clEnumValN(Failure::Crash, "crash", "trap"),
      clEnumValN(Failure::Overflow, "overflow", "no more stack"),
      clEnumValN(Failure::Fatal, "fatal", "LLVM's fatal error"),
      clEnumValN(Failure::Allocation, "allocation", "operator new"),
      clEnumValN(Failure::Memory, "memory", "more and more of it"),
      clEnumValN(Failure::Time, "time", "no end"));
}
static cl::opt<Failure>
    InjectFailureOpt("tpc-inject-failure", cl::cat(Category), cl::Hidden,
                     cl::init(Failure::None),
                     cl::desc("Fail while the analysis runs (for tests)"),
                     failureKinds());
static cl::opt<Failure>
    InjectLateFailureOpt("tpc-inject-late-failure", cl::cat(Category),
                         cl::Hidden, cl::init(Failure::None),
                         cl::desc("Fail when the analysis ends (for tests)"),
                         failureKinds());

/// The linker's `-o` and `-shared`, taken from the command line of this
/// process. The module of a link is always called ld-temp.o, and the linker
/// tells a plugin nothing else.
static void readOwnCommandLine(Options &O) {
  const std::vector<std::string> Words = ownCommandLine();
  O.SharedLibrary =
      is_contained(Words, "-shared") || is_contained(Words, "--shared");
  auto Output = find(Words, "-o");
  if (O.LinkUnit.empty() && Output != Words.end() && Output + 1 != Words.end())
    O.LinkUnit = sys::path::filename(Output[1]).str();
}

AnalysisKey OptionsAnalysis::Key;

Options OptionsAnalysis::run(Module &, ModuleAnalysisManager &) {
  if (Known)
    return *Known;
  Options O;
  O.LinkUnit = LinkUnitOpt;
  readOwnCommandLine(O);
  if (O.LinkUnit.empty())
    O.LinkUnit = "unnamed";
  O.Package = PackageOpt;
  O.SourceRoot = SourceRootOpt;
  O.StaticInfo = StaticInfoOpt;
  O.Profile = ProfileOpt;
  O.RuleFiles.assign(RulesOpt.begin(), RulesOpt.end());
  O.Excluded = {"/usr", "/opt/ros"};
  for (const std::string &Folder : ExcludeOpt)
    O.Excluded.push_back(Folder);
  O.Analyse = AnalyseOpt;
  O.Instrument = InstrumentOpt;
  O.Constants = ConstantsOpt;
  O.Prelink = PrelinkOpt;
  O.Manifest = ManifestOpt;
  O.PlanOut = PlanOutOpt;
  O.Plans.assign(PlanOpt.begin(), PlanOpt.end());
  append_range(O.Plans, plansOfFolder());
  O.MaxSeconds = MaxSecondsOpt;
  O.MaxMemory = MaxMemoryOpt;
  O.InjectFailure = InjectFailureOpt;
  O.InjectLateFailure = InjectLateFailureOpt;
  return O;
}

/// True where \p Path is \p Folder or below it.
static bool isBelow(StringRef Path, StringRef Folder) {
  Folder = Folder.rtrim('/');
  return Path.starts_with(Folder) &&
         (Path.size() == Folder.size() || Path[Folder.size()] == '/');
}

/// True if \p Path is a header that is installed beside those of ROS itself:
/// ROS may be in any folder, such as an environment of conda or of Python.
static bool isInstalledWithRos(StringRef Path) {
  static constexpr StringLiteral Include = "/include/";
  for (size_t At = Path.find(Include); At != StringRef::npos;
       At = Path.find(Include, At + 1)) {
    const std::string Folder = Path.take_front(At + Include.size()).str();
    if (sys::fs::exists(Folder + "rclcpp/rclcpp/rclcpp.hpp") ||
        sys::fs::exists(Folder + "ros/ros.h"))
      return true;
  }
  return false;
}

bool Options::isUserSource(StringRef Path) const {
  if (Path.empty())
    return false;
  // A workspace may be below /usr, so the longer of the two folders decides.
  size_t Own = !SourceRoot.empty() && isBelow(Path, SourceRoot)
                   ? StringRef(SourceRoot).rtrim('/').size()
                   : 0;
  if (any_of(Excluded, [&](const std::string &F) {
        return isBelow(Path, F) && StringRef(F).rtrim('/').size() >= Own;
      }))
    return false;
  return Own || !isInstalledWithRos(Path);
}

std::string Options::relative(StringRef Path) const {
  if (KeepAbsolute || SourceRoot.empty() || !isBelow(Path, SourceRoot))
    return Path.str();
  return Path.drop_front(StringRef(SourceRoot).rtrim('/').size())
      .ltrim('/')
      .str();
}

bool UserSources::has(const DIFile *File) {
  auto [It, New] = Known.try_emplace(File, false);
  if (New)
    It->second = Opts.isUserSource(pathOf(File));
  return It->second;
}

bool UserSources::has(const Function &F) {
  const DISubprogram *SP = F.getSubprogram();
  return SP && has(SP->getFile());
}

bool UserSources::has(const DILocation *Loc) {
  return Loc && has(Loc->getFile());
}

void warn(const Options &Opts, const Twine &Text) {
  WithColor::warning(errs(), "tpc") << Opts.LinkUnit << ": " << Text << '\n';
}

std::string pathOf(const DILocation *Loc) {
  return Loc ? pathOf(Loc->getFile()) : "";
}

} // namespace tpc
