//===- LinkUnit.cpp -------------------------------------------------------===//
#include "LinkUnit.h"

#include "Options.h"
#include "Rules.h"
#include "calls/SimpleCallGraph.h"
#include "control/IfStatements.h"
#include "control/Throws.h"
#include "instrument/Instances.h"
#include "instrument/InstrumentBranches.h"
#include "instrument/InstrumentNodes.h"
#include "instrument/InstrumentReads.h"
#include "memory/AccessIndex.h"
#include "memory/Aliases.h"
#include "memory/CalledBack.h"
#include "memory/LocationTypes.h"
#include "memory/PointsTo.h"
#include "memory/VisibleWrites.h"
#include "output/Findings.h"
#include "params/ParamCallFinder.h"
#include "params/ParamUsageFinder.h"
#include "plan/ApplyPlans.h"
#include "plan/Manifest.h"
#include "plan/PlanWriter.h"
#include "plan/PlansFolder.h"
#include "results/GatherResults.h"
#include "results/LoopDepths.h"
#include "slice/BackwardPropagate.h"
#include "slice/ExternCallFinder.h"
#include "support/Budget.h"
#include "support/DebugTypes.h"
#include "support/Guard.h"

#include "llvm/IR/DebugInfo.h"
#include "llvm/IR/Module.h"
#include "llvm/IR/PassTimingInfo.h"
#include "llvm/Support/CommandLine.h"
#include "llvm/Support/FileSystem.h"
#include "llvm/Transforms/IPO/GlobalDCE.h"

using namespace llvm;

namespace tpc {

void registerAnalyses(ModuleAnalysisManager &AM) {
  AM.registerPass([] { return OptionsAnalysis(); });
  AM.registerPass([] { return RuleTableAnalysis(); });
  AM.registerPass([] { return RuleAnalysis(); });
  AM.registerPass([] { return SimpleCallGraph(); });
  AM.registerPass([] { return DebugTypesAnalysis(); });
  AM.registerPass([] { return CalledBackAnalysis(); });
  AM.registerPass([] { return LocationTypesAnalysis(); });
  AM.registerPass([] { return AliasesAnalysis(); });
  AM.registerPass([] { return PointsToAnalysis(); });
  AM.registerPass([] { return ClassObjectAccess(); });
  AM.registerPass([] { return VisibleWritesAnalysis(); });
  AM.registerPass([] { return Throws(); });
  AM.registerPass([] { return IfStatements(); });
  AM.registerPass([] { return ExternCallFinder(); });
  AM.registerPass([] { return ParamCallFinder(); });
  AM.registerPass([] { return BackwardPropagate(); });
  AM.registerPass([] { return ParamUsageFinder(); });
  AM.registerPass([] { return GatherResults(); });
  AM.registerPass([] { return LoopDepths(); });
}

namespace {
/// The analysis manager of one analysed copy. The manager of the link cannot be
/// used: it caches results for the user's module, which is not analysed, and it
/// outlives the copies.
struct OwnAnalyses {
  PassInstrumentationCallbacks Callbacks;
  TimePassesHandler Times; ///< for `-time-passes`
  FunctionAnalysisManager FAM;
  ModuleAnalysisManager AM;
  OwnAnalyses(const Options &Opts, const RuleTables &Rules) {
    Times.registerCallbacks(Callbacks);
    AM.registerPass([&] { return OptionsAnalysis(Opts); });
    AM.registerPass([&] { return RuleTableAnalysis(Rules); });
    PassBuilder PB(nullptr, PipelineTuningOptions(), std::nullopt, &Callbacks);
    PB.registerModuleAnalyses(AM);
    PB.registerFunctionAnalyses(FAM);
    AM.registerPass([&] { return FunctionAnalysisManagerModuleProxy(FAM); });
    FAM.registerPass([&] { return ModuleAnalysisManagerFunctionProxy(AM); });
    registerAnalyses(AM);
  }
};
} // namespace

static cl::opt<std::string>
    SpentStage("tpc-spend", cl::Hidden,
               cl::desc("Leave nothing to this stage (for tests)"));

template <typename Analysis>
static void runWithin(double Fraction, Module &M, ModuleAnalysisManager &AM) {
  Budget::Share Part(Fraction);
  if (Analysis::name() == SpentStage)
    Budget::spend();
  AM.getResult<Analysis>(M);
}

/// Runs the expensive stages in order. Each may use most of what is left of the
/// budget, but not all.
static void analyse(Module &Seen, ModuleAnalysisManager &AM) {
  runWithin<PointsToAnalysis>(0.7, Seen, AM);
  runWithin<VisibleWritesAnalysis>(0.7, Seen, AM);
  runWithin<IfStatements>(0.7, Seen, AM);
  runWithin<BackwardPropagate>(0.7, Seen, AM);
  runWithin<ParamUsageFinder>(0.7, Seen, AM);
  runWithin<GatherResults>(1, Seen, AM);
}

/// The functions that must be copied for each of their calls before a report
/// inside them is unambiguous. Callers come before callees: a copy of a caller
/// has calls of its own.
static std::vector<std::string> findSharedFunctions(Module &Seen,
                                                    ModuleAnalysisManager &AM) {
  const auto &Shared = AM.getResult<GatherResults>(Seen).Shared;
  SmallPtrSet<Function *, 8> Done;
  std::vector<std::string> Names;
  auto Add = [&](auto &Self, Function *F) -> void {
    if (!Done.insert(F).second)
      return;
    SmallPtrSet<Function *, 8> Callers;
    for (const User *U : F->users())
      if (const auto *Call = dyn_cast<CallBase>(U))
        Callers.insert(const_cast<Function *>(Call->getFunction()));
    for (Function *Caller : Shared)
      if (Callers.contains(Caller))
        Self(Self, Caller);
    Names.push_back(F->getName().str());
  };
  for (Function *F : Shared)
    Add(Add, F);
  return Names;
}

/// Plans a report for each comparison found in \p Analysed. The link unit is
/// unchanged up to this call.
static void planReports(AnalysedModule &Analysed, ModuleAnalysisManager &AM,
                        const Options &Opts, Findings &Out,
                        PlannedFindings &Of) {
  Module &Seen = Analysed.module();
  const GatheredResults &R = AM.getResult<GatherResults>(Seen);
  if (R.Comparisons.empty() && !(Opts.Constants && !R.Constants.empty()))
    return;
  Out.IsChanged = Analysed.isSeparated();
  if (!Analysed.bringBack()) {
    Out.Failure = "the analysed copy no longer matches the program";
    return;
  }
  const ParamCallFinder::Result &Reads = AM.getResult<ParamCallFinder>(Seen);
  Instances Objects(Analysed, AM.getResult<DebugTypesAnalysis>(Seen), Reads);
  auto Plan = [&](const Comparison &C, bool IsUnsigned) {
    std::optional<Report> Plan = planReport(C, IsUnsigned, Analysed);
    if (!Plan) {
      Of.WithoutReport.push_back(&C);
      return;
    }
    Plan->Object = Objects.objectOf(C, *Plan->Before);
    Out.Reports.push_back(std::move(*Plan));
    Of.Reported.push_back(&C);
  };
  for (const Comparison &C : R.Comparisons) {
    // What has not been copied for its calls would report them all.
    if (!Out.Incomplete.empty() &&
        R.Shared.contains(const_cast<Function *>(C.place().getFunction()))) {
      Of.WithoutReport.push_back(&C);
      continue;
    }
    StringRef Type = Reads[C.Reads.front()].Type;
    Plan(C, Type.starts_with("unsigned") || Type == "bool");
  }
  if (Opts.Constants)
    for (const Comparison &C : R.Constants)
      Plan(C, /*IsUnsigned=*/false);
  for (const ParameterRead &Read : Reads)
    if (std::optional<NamedRead> Name = planName(Read, Analysed)) {
      Out.Names.push_back(std::move(*Name));
      Of.Named.push_back(&Read);
    }
  Out.NotInstrumented = Of.WithoutReport.size();
  Out.Nodes = !Out.Reports.empty() || !Out.Names.empty();
}

/// Each round analyses the link unit again. Checks are rarely nested more
/// deeply than this.
static cl::opt<unsigned> MaxSeparated(
    "tpc-max-separated", cl::Hidden, cl::init(3),
    cl::desc("Nesting of functions that are copied for each of their calls"));

/// Looks for findings so that a crash, an endless loop or exhausted memory only
/// makes that fail, not the link; \p Crashed is what the user is told then.
static Findings findSafely(StringRef Crashed,
                           function_ref<void(Findings &)> Find) {
  auto Out = std::make_unique<Findings>();
  if (!runGuarded([&] { Find(*Out); })) {
    // Never destroy what a crash left half built.
    bool IsChanged = Out.release()->IsChanged;
    Out = std::make_unique<Findings>();
    Out->Failure = Crashed.str();
    Out->IsChanged = IsChanged;
  }
  return std::move(*Out);
}

/// Analyses \p M, which changes only if reports are planned.
static Findings analyseSafely(Module &M, ModuleAnalysisManager &AM,
                              const Options &Opts) {
  return findSafely("the analysis crashed", [&](Findings &Out) {
    const RuleTables &Rules = AM.getResult<RuleTableAnalysis>(M);
    Out.Failure = Rules.Error;
    if (!Out.Failure.empty())
      return;
    Budget Limits(Opts.MaxSeconds, Opts.MaxMemory);
    AnalysedModule Analysed(M, Opts, Rules.Tables);
    auto Own = std::make_unique<OwnAnalyses>(Opts, Rules);
    // Nothing is known of the changed program.
    auto Separate = [&](std::vector<std::string> Names) {
      if (!Analysed.separate(std::move(Names), [&] { Own.reset(); }))
        return false;
      Own = std::make_unique<OwnAnalyses>(Opts, Rules);
      return true;
    };
    Separate(namedByCalls(Analysed.module(), Own->AM));
    for (unsigned Round = 0;; ++Round) {
      fail(Opts.InjectFailure);
      double Before = Limits.used();
      Module &Seen = Analysed.module();
      analyse(Seen, Own->AM);
      std::vector<std::string> Shared = findSharedFunctions(Seen, Own->AM);
      // Another round takes about as long, and begins from nothing.
      double After = Limits.used();
      if (!Shared.empty() && Round < MaxSeparated && After + After - Before > 1)
        Limits.leaveOut();
      if (Limits.why().empty() && Round < MaxSeparated &&
          Separate(std::move(Shared)))
        continue;
      Out.Unit = describe(Seen, Own->AM, Opts);
      Out.Incomplete = Limits.why();
      fail(Opts.InjectLateFailure);
      PlannedFindings Of;
      if (Opts.Instrument || !Opts.PlanOut.empty())
        planReports(Analysed, Own->AM, Opts, Out, Of);
      if (!Opts.PlanOut.empty() && Out.Failure.empty())
        writePlan(M, Analysed, Own->AM, Opts, Out, Of);
      return;
    }
  });
}

/// Takes the findings from plans.
static Findings applySafely(Module &M, ModuleAnalysisManager &AM,
                            const Options &Opts) {
  return findSafely("the plans crashed TPC", [&](Findings &Out) {
    const RuleTables &Rules = AM.getResult<RuleTableAnalysis>(M);
    Out.Failure = Rules.Error;
    if (Out.Failure.empty())
      applyPlans(M, *Rules.Tables, Opts, Out);
  });
}

/// Writes what this link needs, so that it can be repeated.
static void writeManifest(const Options &Opts) {
  std::string Why;
  if (!runGuarded([&] {
        if (Error E = writeJsonText(describeLink(Opts), Opts.Manifest))
          Why = toString(std::move(E));
      }))
    Why = "it crashed";
  if (!Why.empty())
    warn(Opts, "cannot write the manifest: " + Why);
}

PreservedAnalyses LinkUnitPass::run(Module &M, ModuleAnalysisManager &AM) {
  const Options &Opts = AM.getResult<OptionsAnalysis>(M);
  if (!Opts.Manifest.empty())
    writeManifest(Opts);
  // That of an earlier link is about another program.
  if (!Opts.PlanOut.empty() && Opts.Plans.empty())
    sys::fs::remove(Opts.PlanOut);
  if (!Opts.Analyse)
    return PreservedAnalyses::all();
  if (isAnalysedLater()) {
    // What an earlier link reported, this one does not.
    sys::fs::remove(Opts.StaticInfo);
    return PreservedAnalyses::all();
  }
  Findings F = Opts.Plans.empty() ? analyseSafely(M, AM, Opts)
                                  : applySafely(M, AM, Opts);
  if (F.Failure.empty() && Opts.Instrument) {
    // The module is verified with both.
    SmallVector<Instruction *, 0> Names = insertNames(M, F.Names);
    if (F.Nodes)
      append_range(Names,
                   insertNodes(M, *AM.getResult<RuleTableAnalysis>(M).Tables));
    F.Failure = insertReports(M, F.Reports);
    if (!F.Failure.empty())
      for (Instruction *I : reverse(Names))
        I->eraseFromParent();
  }
  if (!F.Failure.empty()) {
    warn(Opts, F.Failure + (F.IsChanged ? "; this link unit gets no reports"
                                        : "; this link unit is not changed"));
    F.Unit =
        describeFailure(Opts, F.Failure, F.Unit.Fields.getObject("counts"));
  } else {
    if (json::Object *Counts = F.Unit.Fields.getObject("counts"))
      (*Counts)["not_instrumented"] = F.NotInstrumented;
    if (!F.Incomplete.empty()) {
      F.Unit.Fields["incomplete"] = F.Incomplete;
      warn(Opts, F.Incomplete + "; the comparisons found so far will report, "
                                "others may be missing");
    }
  }
  if (!Opts.StaticInfo.empty())
    if (Error E = writeJson(std::move(F.Unit), Opts.StaticInfo))
      warn(Opts,
           "cannot write the static information: " + toString(std::move(E)));
  return PreservedAnalyses::none();
}

/// The optimisation level that the compilers of \p M's files were given; the
/// highest one if they differ. Clang records its command line with
/// `-grecord-command-line`, and marks functions compiled with -O0, -Os and -Oz.
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
                .Case("-O", OptimizationLevel::O1)
                .Case("-O1", OptimizationLevel::O1)
                .Case("-Og", OptimizationLevel::O1)
                .Case("-O2", OptimizationLevel::O2)
                .Case("-Os", OptimizationLevel::O2)
                .Case("-Oz", OptimizationLevel::O2)
                .Case("-O3", OptimizationLevel::O3)
                .Case("-O4", OptimizationLevel::O3)
                .Case("-Ofast", OptimizationLevel::O3)
                .Default(Own);
    if (Own.getSpeedupLevel() > Level.getSpeedupLevel())
      Level = Own;
  }
  return Level;
}

/// Keeps all later passes and the code generator from optimising \p M.
static void leaveUnoptimised(Module &M) {
  for (Function &F : M) {
    if (F.isDeclaration() || F.hasFnAttribute(Attribute::AlwaysInline))
      continue;
    for (Attribute::AttrKind Kind :
         {Attribute::OptimizeForSize, Attribute::MinSize})
      F.removeFnAttr(Kind);
    F.addFnAttr(Attribute::NoInline);
    F.addFnAttr(Attribute::OptimizeNone);
  }
}

PreservedAnalyses PrelinkPass::run(Module &M, ModuleAnalysisManager &AM) {
  const Options &Opts = AM.getResult<OptionsAnalysis>(M);
  if (!Opts.Prelink)
    return PreservedAnalyses::all();
  // It is linked again, so this program is only used during the build, and
  // nobody debugs it. What the compiler would have removed is still there.
  if (Opts.Analyse && isAnalysedLater()) {
    StripDebugInfo(M);
    GlobalDCEPass().run(M, AM);
    leaveUnoptimised(M);
    return PB.buildLTOPreLinkDefaultPipeline(OptimizationLevel::O0).run(M, AM);
  }
  // The pipeline is built inside the pass because its level is known only once
  // the module is read.
  return PB.buildLTOPreLinkDefaultPipeline(levelOf(M)).run(M, AM);
}

} // namespace tpc
