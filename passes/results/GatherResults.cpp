//===- GatherResults.cpp --------------------------------------------------===//
#include "results/GatherResults.h"

#include "Options.h"
#include "Rules.h"
#include "calls/SimpleCallGraph.h"
#include "control/Conditions.h"
#include "control/IfStatements.h"
#include "params/ParamCallFinder.h"
#include "results/ConstantFinder.h"
#include "results/Keys.h"
#include "results/Sides.h"
#include "support/Budget.h"
#include "support/Names.h"

#include "llvm/ADT/SetVector.h"
#include "llvm/ADT/SmallPtrSet.h"
#include "llvm/ADT/Statistic.h"
#include "llvm/Analysis/ValueTracking.h"
#include "llvm/IR/Instructions.h"
#include "llvm/IR/Module.h"
#include "llvm/Support/Debug.h"

using namespace llvm;

namespace tpc {

#define DEBUG_TYPE "tpc-gather-results"
STATISTIC(NumComparisons, "Threshold predicate comparisons");
STATISTIC(NumConstants, "Comparisons with constants");
STATISTIC(NumNotExposed, "Comparisons that no exposing statement depends on");
STATISTIC(NumOutside, "Comparisons outside of the user's sources");

AnalysisKey GatherResults::Key;

StringRef Comparison::typeName() const {
  switch (Type) {
  case Parameter:
    return "parameter";
  case Flag:
    return "flag";
  case Derived:
    return "derived";
  case Constant:
    return "constant";
  }
  llvm_unreachable("no such type");
}

std::string whatOf(const Comparison &C, const ParamCallFinder::Result &Reads) {
  return C.Type == Comparison::Constant ? "constant " + C.ConstantName
                                        : Reads[C.Reads.front()].Name;
}

StringRef Comparison::relation() const {
  if (!TextRelation.empty())
    return TextRelation;
  if (!Compare)
    return "flag";
  StringRef Relation =
      relationOf(Threshold == 1 ? Compare->getPredicate()
                                : Compare->getSwappedPredicate());
  assert(!Relation.empty() && "see comparesValues()");
  return Relation;
}

/// The nearest predicate that \p C decides and an exposing statement depends
/// on; the first of several at the same distance.
static bool findNearest(const ParameterComparison &C, const SliceResult &Slice,
                        Comparison &Out) {
  bool Found = false;
  for (const Decision &D : C.Decisions) {
    std::optional<SliceEntry> E = Slice.lookup(D.Predicate);
    if (!E || (Found && E->Distance >= Out.Slice.Distance))
      continue;
    Found = true;
    Out.Predicate = D.Predicate;
    Out.Direct = D.Direct;
    Out.Way = D.Way;
    Out.Slice = *E;
  }
  return Found;
}

/// Counts for each comparison the other comparisons with parameters in its
/// condition.
static void countOthers(GatheredResults &R) {
  SmallVector<const Instruction *, 0> Predicates;
  for (const auto *List : {&R.Comparisons, &R.Constants})
    for (const Comparison &C : *List)
      Predicates.push_back(C.Predicate);
  const Conditions All(Predicates);
  // A condition has few comparisons, a link unit has many.
  DenseMap<const Instruction *, SmallVector<const Comparison *, 2>> ByCondition;
  for (const Comparison &C : R.Comparisons)
    ByCondition[All.of(*C.Predicate)].push_back(&C);
  for (auto *List : {&R.Comparisons, &R.Constants})
    for (Comparison &C : *List)
      C.OtherThresholds = count_if(
          ByCondition.lookup(All.of(*C.Predicate)), [&](const Comparison *O) {
            return O != &C && (O->Compare != C.Compare || !C.Compare);
          });
}

namespace {

/// Gives comparisons their keys. Several comparisons from one macro share a
/// place; their order in the function distinguishes them. All instances of a
/// function have the same keys, also after inlining.
class Namer {
public:
  explicit Namer(const Options &Opts) : Opts(Opts) {}

  /// \p What is the parameter or the constant.
  void name(Comparison &C, StringRef What) {
    std::string Name = nameOfComparison(KeyParts::of(*C.Where, What), Opts);
    auto &Here =
        Places[Name][{C.place().getFunction(), C.Where->getInlinedAt()}];
    auto *Known = find(Here, &C.place());
    C.Ordinal = Known - Here.begin();
    if (Known == Here.end())
      Here.push_back(&C.place());
    C.Key = comparisonKey(std::move(Name), C.Ordinal);
  }

private:
  using Instance = std::pair<const Function *, const DILocation *>;
  const Options &Opts;
  StringMap<DenseMap<Instance, SmallVector<const Instruction *, 1>>> Places;
};

/// Finds the places of comparisons in user code.
class Places {
public:
  Places(const Options &Opts, const RuleMatches &Rules)
      : Sources(Opts), Rules(Rules) {}

  /// The place of \p I, or of the call of the transparent function that
  /// contains it; null if it is not in user code.
  const DILocation *of(const Instruction &I) {
    const DISubprogram *Through = nullptr;
    const DILocation *Loc = I.getDebugLoc();
    for (; Loc && !Sources.has(Loc); Loc = Loc->getInlinedAt())
      Through = Loc->getScope()->getSubprogram();
    return Loc && (!Through || Rules.isTransparent(*Through)) ? Loc : nullptr;
  }

private:
  UserSources Sources;
  const RuleMatches &Rules;
};

} // namespace

/// True if \p Compare tests a global object of an opaque class, as the macros
/// for logging do.
static bool asksLibrary(const CmpInst &Compare, const RuleMatches &Rules) {
  return any_of(Compare.operands(), [&](const Use &U) {
    const auto *Load = dyn_cast<LoadInst>(U);
    const auto *Global = Load ? dyn_cast<GlobalVariable>(getUnderlyingObject(
                                    Load->getPointerOperand()))
                              : nullptr;
    const auto *Class =
        Global ? dyn_cast<StructType>(Global->getValueType()) : nullptr;
    return Class && Rules.isOpaque(plainClassName(*Class));
  });
}

static SmallPtrSet<const CmpInst *, 16> decidingOf(const ParameterUsage &Usage,
                                                   const SliceResult &Slice) {
  SmallPtrSet<const CmpInst *, 16> Deciding;
  Comparison Ignored{};
  for (const ParameterComparison &P : Usage.Comparisons)
    if (P.Compare && findNearest(P, Slice, Ignored))
      Deciding.insert(P.Compare);
  return Deciding;
}

/// \p P without the fields that depend on its surroundings.
static Comparison comparisonOf(const ParameterComparison &P) {
  Comparison C{};
  C.Compare = P.Compare;
  C.Threshold = P.Operand;
  C.FlagValue = P.Flag;
  C.TextRelation = P.TextRelation;
  C.IsOperand = P.IsOperand;
  if (!P.How.isNarrowing())
    C.How = P.How;
  C.How.Part = P.How.Part;
  bool IsItself = C.How.kind() == Transform::None && C.How.Part.empty();
  C.Type = !IsItself                          ? Comparison::Derived
           : P.Flag && P.TextRelation.empty() ? Comparison::Flag
                                              : Comparison::Parameter;
  C.Reads.push_back(P.Read);
  return C;
}

namespace {

/// Collects the comparisons with parameters to report.
class Gatherer {
public:
  Gatherer(Module &M, ModuleAnalysisManager &AM, Places &Own)
      : Usage(AM.getResult<ParamUsageFinder>(M)),
        Reads(AM.getResult<ParamCallFinder>(M)),
        Slice(AM.getResult<BackwardPropagate>(M)),
        Deciding(decidingOf(Usage, Slice)), Own(Own),
        Both(Usage, Reads, AM.getResult<SimpleCallGraph>(M),
             AM.getResult<PointsToAnalysis>(M),
             AM.getResult<VisibleWritesAnalysis>(M),
             [&](const ParameterComparison &P) {
               Comparison Ignored{};
               return isExposed(P, Ignored);
             }) {}

  GatheredResults run() {
    for (const ParameterComparison &P : Usage.Comparisons) {
      if (Budget::isSpent())
        break;
      if (std::optional<NotReported::WhyTy> Why = gather(P)) {
        LLVM_DEBUG(dbgs() << "not reported (" << *Why << "): " << P.place()
                          << '\n');
        NumNotExposed += *Why == NotReported::NotExposed;
        R.Others.push_back({&P, *Why});
      }
    }
    return std::move(R);
  }
  /// For run(): what is compared with a parameter.
  bool isWithParameter(const CmpInst &Compare) const {
    return WithParameter.contains(&Compare);
  }

private:
  std::optional<NotReported::WhyTy> gather(const ParameterComparison &P);
  bool isExposed(const ParameterComparison &P, Comparison &Out) const;
  void add(Comparison C);

  const ParameterUsage &Usage;
  const ParamCallFinder::Result &Reads;
  const SliceResult &Slice;
  /// Comparisons that a predicate in the slice depends on.
  const SmallPtrSet<const CmpInst *, 16> Deciding;
  Places &Own;
  Sides Both;
  GatheredResults R;
  SmallPtrSet<const CmpInst *, 16> WithParameter;
  /// Indices of comparisons, by the value that compares.
  DenseMap<const Value *, SmallVector<unsigned, 1>> Known;
};

} // namespace

/// True if an exposing statement depends on \p P: on the nearest predicate that
/// it decides or, without one, on its outcome, as in `message.data = x <
/// limit`.
bool Gatherer::isExposed(const ParameterComparison &P, Comparison &Out) const {
  if (findNearest(P, Slice, Out))
    return true;
  if (!P.Compare || !P.TextRelation.empty() || Deciding.contains(P.Compare))
    return false;
  std::optional<SliceEntry> Shown = Slice.shown(P.Compare);
  if (!Shown)
    return false;
  Out.Predicate = P.Compare;
  Out.Direct = false;
  Out.Way = Hop::None;
  Out.Slice = *Shown;
  return true;
}

/// Why \p P is not reported; none if it is.
std::optional<NotReported::WhyTy>
Gatherer::gather(const ParameterComparison &P) {
  Comparison C = comparisonOf(P);
  if (!isExposed(P, C))
    return NotReported::NotExposed;
  WithParameter.insert(P.Compare);
  if (P.Flag)
    WithParameter.insert(dyn_cast<CmpInst>(P.Flag));
  C.Where = Own.of(C.place());
  if (!C.Where && C.place().getDebugLoc()) {
    ++R.OutsideSources;
    return NotReported::OutsideSources;
  }
  if (!C.Where) {
    ++R.WithoutDebugInfo;
    return NotReported::WithoutDebugInfo;
  }
  // The same comparison is reported for its other operand.
  if (Both.isOtherWay(P, *C.Predicate))
    return std::nullopt;
  if (Both.isMeasured(P, *C.Predicate))
    return NotReported::Measured;
  if (P.ByArgument)
    R.Shared.insert(const_cast<Function *>(C.place().getFunction()));
  add(std::move(C));
  return std::nullopt;
}

/// Adds \p C, the comparison of one read. A second read of the same parameter
/// is the same comparison.
void Gatherer::add(Comparison C) {
  unsigned Read = C.Reads.front();
  SmallVector<unsigned, 1> &Alike = Known[C.Compare ? C.Compare : C.FlagValue];
  auto *Same = find_if(Alike, [&](unsigned N) {
    const Comparison &O = R.Comparisons[N];
    return O.Compare == C.Compare && O.Predicate == C.Predicate &&
           O.FlagValue == C.FlagValue && O.Threshold == C.Threshold &&
           Reads[O.Reads.front()].Name == Reads[Read].Name;
  });
  if (Same == Alike.end()) {
    Alike.push_back(R.Comparisons.size());
    R.Comparisons.push_back(std::move(C));
  } else if (auto &All = R.Comparisons[*Same].Reads; !is_contained(All, Read)) {
    All.push_back(Read);
  }
}

GatheredResults GatherResults::run(Module &M, ModuleAnalysisManager &AM) {
  const ParamCallFinder::Result &Reads = AM.getResult<ParamCallFinder>(M);
  const Options &Opts = AM.getResult<OptionsAnalysis>(M);
  const RuleMatches &Rules = AM.getResult<RuleAnalysis>(M);
  Places Own(Opts, Rules);
  Gatherer WithParameters(M, AM, Own);
  GatheredResults R = WithParameters.run();
  auto PlaceOf = [&](const CmpInst &Compare) {
    return WithParameters.isWithParameter(Compare) ||
                   asksLibrary(Compare, Rules)
               ? nullptr
               : Own.of(Compare);
  };
  R.Constants = ConstantFinder(AM.getResult<SimpleCallGraph>(M),
                               AM.getResult<LocationTypesAnalysis>(M),
                               AM.getResult<PointsToAnalysis>(M),
                               AM.getResult<VisibleWritesAnalysis>(M),
                               AM.getResult<BackwardPropagate>(M), PlaceOf)
                    .run(AM.getResult<IfStatements>(M).predicates());
  NumComparisons += R.Comparisons.size();
  NumConstants += R.Constants.size();
  NumOutside += R.OutsideSources;
  countOthers(R);
  Namer Keys(Opts);
  for (Comparison &C : R.Comparisons)
    Keys.name(C, whatOf(C, Reads));
  for (Comparison &C : R.Constants)
    Keys.name(C, whatOf(C, Reads));
  return R;
}

/// Prints \p C and its place.
static void print(raw_ostream &OS, const Comparison &C, StringRef What) {
  OS << "  " << C.typeName() << " '" << What << "' relation " << C.relation()
     << " as " << C.How.text() << " distance " << C.Slice.Distance << " others "
     << C.OtherThresholds << " in " << C.place().getFunction()->getName()
     << " at " << C.Where->getLine() << ':' << C.Where->getColumn() << '\n';
}

PreservedAnalyses GatherResultsPrinter::run(Module &M,
                                            ModuleAnalysisManager &AM) {
  const GatheredResults &R = AM.getResult<GatherResults>(M);
  const auto &Reads = AM.getResult<ParamCallFinder>(M);
  OS << "threshold predicate comparisons of " << M.getName() << ": "
     << R.Comparisons.size() << '\n';
  for (const Comparison &C : R.Comparisons)
    print(OS, C, Reads[C.Reads.front()].Name);
  OS << "comparisons with constants: " << R.Constants.size() << '\n';
  for (const Comparison &C : R.Constants)
    print(OS, C, C.ConstantName);
  return PreservedAnalyses::all();
}

} // namespace tpc
