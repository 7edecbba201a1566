//===- LinkUnit.cpp -------------------------------------------------------===//
#include "LinkUnit.h"

#include "BackwardPropagate.h"
#include "ClassObjectAccess.h"
#include "ExternCallFinder.h"
#include "GatherResults.h"
#include "IfStatements.h"
#include "InstrumentBranches.h"
#include "Options.h"
#include "ParamCallFinder.h"
#include "ParamUsageFinder.h"
#include "Rules.h"
#include "SimpleCallGraph.h"
#include "StaticInfo.h"

#include "llvm/IR/Module.h"
#include "llvm/Support/CrashRecoveryContext.h"
#include "llvm/Support/WithColor.h"

using namespace llvm;

namespace tpc {

void registerAnalyses(ModuleAnalysisManager &AM) {
  AM.registerPass([] { return RuleAnalysis(); });
  AM.registerPass([] { return SimpleCallGraph(); });
  AM.registerPass([] { return ClassObjectAccess(); });
  AM.registerPass([] { return IfStatements(); });
  AM.registerPass([] { return ExternCallFinder(); });
  AM.registerPass([] { return ParamCallFinder(); });
  AM.registerPass([] { return BackwardPropagate(); });
  AM.registerPass([] { return ParamUsageFinder(); });
  AM.registerPass([] { return GatherResults(); });
}

/// What the analysis of a unit comes to.
struct Findings {
  json::Object Unit;
  std::vector<Report> Reports;
  unsigned NotInstrumented = 0;
  std::string Failure;
};

/// Analyses \p Analysed; returns the functions whose calls are to be told apart
/// before that says all.
static std::vector<std::string> analyse(AnalysedModule &Analysed,
                                        const Options &Opts, Findings &Out) {
  if (Opts.InjectFailure)
    LLVM_BUILTIN_TRAP;
  // Managers of its own: what is analysed may be a copy that goes away again.
  ModuleAnalysisManager AM;
  PassBuilder().registerModuleAnalyses(AM);
  registerAnalyses(AM);
  Module &Seen = Analysed.module();
  if (const std::string &Error = AM.getResult<RuleAnalysis>(Seen).Error;
      !Error.empty()) {
    Out.Failure = Error;
    return {};
  }
  const GatheredResults &R = AM.getResult<GatherResults>(Seen);
  const ParamCallFinder::Result &Reads = AM.getResult<ParamCallFinder>(Seen);
  auto Plan = [&](const Comparison &C, bool IsUnsigned) {
    if (std::optional<Report> Plan = planReport(C, IsUnsigned, Analysed))
      Out.Reports.push_back(std::move(*Plan));
    else
      ++Out.NotInstrumented;
  };
  for (const Comparison &C : R.Comparisons) {
    StringRef Type = Reads[C.Reads.front()].Type;
    Plan(C, Type.starts_with("unsigned") || Type == "bool");
  }
  if (Opts.Constants)
    for (const Comparison &C : R.Constants)
      Plan(C, /*IsUnsigned=*/false);
  Out.Unit = describe(Seen, AM, Opts);
  std::vector<std::string> Shared;
  for (const Function *F : R.Shared)
    Shared.push_back(F->getName().str());
  return Shared;
}

/// Functions in functions whose calls are told apart.
static constexpr unsigned MaxSeparated = 3;

/// Runs the analysis so that a crash in it is only a failure of it.
static Findings analyseSafely(Module &M, const Options &Opts) {
  Findings Out;
  CrashRecoveryContext::Enable();
  CrashRecoveryContext Guard;
  bool Survived = Guard.RunSafely([&] {
    for (unsigned Round = 0; Round <= MaxSeparated; ++Round) {
      Out = Findings();
      AnalysedModule Analysed(M, Opts);
      std::vector<std::string> Shared = analyse(Analysed, Opts, Out);
      if (Round == MaxSeparated || !separateCalls(M, Shared))
        break;
    }
  });
  if (!Survived) {
    Out = Findings();
    Out.Failure = "the analysis crashed";
  }
  return Out;
}

static void warn(const Options &Opts, const Twine &Text) {
  WithColor::warning(errs(), "tpc") << Opts.LinkUnit << ": " << Text << '\n';
}

PreservedAnalyses LinkUnitPass::run(Module &M, ModuleAnalysisManager &) {
  const Options Opts = Options::fromCommandLine();
  Findings F = analyseSafely(M, Opts);
  if (F.Failure.empty() && Opts.Instrument)
    if (std::string Why = insertReports(M, F.Reports); !Why.empty())
      F.Failure = "the instrumented module does not verify: " +
                  StringRef(Why).split('\n').first.str();
  if (!F.Failure.empty()) {
    warn(Opts, F.Failure + "; this link unit is left as it was");
    F.Unit = describeFailure(Opts, F.Failure);
  } else if (json::Object *Counts = F.Unit.getObject("counts")) {
    (*Counts)["not_instrumented"] = F.NotInstrumented;
  }
  if (!Opts.StaticInfo.empty())
    if (Error E = writeJson(std::move(F.Unit), Opts.StaticInfo))
      warn(Opts, "static information not written: " + toString(std::move(E)));
  return PreservedAnalyses::none();
}

/// The level that the compilers of \p M's files were asked for, the highest
/// where they differ. Clang records its command line where it is told to
/// (`-grecord-command-line`); functions of -O0, -Os and -Oz are marked.
static OptimizationLevel levelOf(const Module &M) {
  OptimizationLevel Level = OptimizationLevel::O0;
  for (const DICompileUnit *Unit : M.debug_compile_units()) {
    OptimizationLevel Own =
        Unit->isOptimized() ? OptimizationLevel::O2 : OptimizationLevel::O0;
    SmallVector<StringRef, 64> Words;
    Unit->getFlags().split(Words, ' ');
    for (StringRef Word : Words)
      Own = StringSwitch<OptimizationLevel>(Word)
                .Case("-O0", OptimizationLevel::O0)
                .Cases("-O", "-O1", "-Og", OptimizationLevel::O1)
                .Cases("-O2", "-Os", "-Oz", OptimizationLevel::O2)
                .Cases("-O3", "-O4", "-Ofast", OptimizationLevel::O3)
                .Default(Own);
    if (Own.getSpeedupLevel() > Level.getSpeedupLevel())
      Level = Own;
  }
  return Level;
}

PreservedAnalyses PrelinkPass::run(Module &M, ModuleAnalysisManager &AM) {
  if (!Options::fromCommandLine().Prelink)
    return PreservedAnalyses::all();
  return PB.buildLTOPreLinkDefaultPipeline(levelOf(M)).run(M, AM);
}

} // namespace tpc
