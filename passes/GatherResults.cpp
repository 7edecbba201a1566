//===- GatherResults.cpp --------------------------------------------------===//
#include "GatherResults.h"

#include "IfStatements.h"
#include "Options.h"
#include "ParamCallFinder.h"
#include "Print.h"

#include "llvm/ADT/EquivalenceClasses.h"
#include "llvm/IR/CFG.h"
#include "llvm/IR/Instructions.h"
#include "llvm/IR/Module.h"

using namespace llvm;

namespace tpc {

AnalysisKey GatherResults::Key;

StringRef Comparison::typeName() const {
  switch (Type) {
  case Parameter:
    return "parameter";
  case Flag:
    return "flag";
  case Derived:
    return "derived";
  }
  llvm_unreachable("no such type");
}

StringRef Comparison::relation() const {
  if (!Compare)
    return "flag";
  CmpInst::Predicate P =
      Threshold == 1 ? Compare->getPredicate() : Compare->getSwappedPredicate();
  switch (P) {
  case CmpInst::ICMP_EQ:
  case CmpInst::FCMP_OEQ:
  case CmpInst::FCMP_UEQ:
    return "==";
  case CmpInst::ICMP_NE:
  case CmpInst::FCMP_ONE:
  case CmpInst::FCMP_UNE:
    return "!=";
  case CmpInst::ICMP_SGT:
  case CmpInst::ICMP_UGT:
  case CmpInst::FCMP_OGT:
  case CmpInst::FCMP_UGT:
    return ">";
  case CmpInst::ICMP_SGE:
  case CmpInst::ICMP_UGE:
  case CmpInst::FCMP_OGE:
  case CmpInst::FCMP_UGE:
    return ">=";
  case CmpInst::ICMP_SLT:
  case CmpInst::ICMP_ULT:
  case CmpInst::FCMP_OLT:
  case CmpInst::FCMP_ULT:
    return "<";
  default:
    return "<=";
  }
}

/// The nearest of the predicates that \p C decides and that an exposing
/// statement depends on; of several equally near ones the first.
static bool nearest(const ParameterComparison &C, const SliceResult &Slice,
                    Comparison &Out) {
  bool Found = false;
  for (const Decision &D : C.Decisions) {
    std::optional<SliceEntry> E = Slice.lookup(D.Predicate);
    if (!E || (Found && E->Distance >= Out.Slice.Distance))
      continue;
    Found = true;
    Out.Predicate = D.Predicate;
    Out.Direct = D.Direct;
    Out.Slice = *E;
  }
  return Found;
}

/// The next conditional branch on the way from \p BB that runs nothing
/// conditional in between.
static const BranchInst *nextBranch(const BasicBlock *BB) {
  for (unsigned Steps = 0; Steps < 16; ++Steps) {
    const Instruction *T = BB->getTerminator();
    if (const auto *Invoke = dyn_cast<InvokeInst>(T)) {
      BB = Invoke->getNormalDest();
      continue;
    }
    const auto *Br = dyn_cast<BranchInst>(T);
    if (!Br || Br->isConditional())
      return Br;
    BB = Br->getSuccessor(0);
  }
  return nullptr;
}

/// True where \p A and \p B are operands of one `&&` or `||`, A before B: they
/// share a way out, and belong to one statement. Clang gives a statement's
/// condition a scope of its own, in which all operands stand but the last; that
/// one has the statement's place.
static bool sameCondition(const BranchInst &A, const BranchInst &B) {
  const DILocation *LocA = A.getDebugLoc(), *LocB = B.getDebugLoc();
  if (!LocA || !LocB)
    return false;
  const auto *Scope = dyn_cast<DILexicalBlock>(LocA->getScope());
  bool LastOperand = Scope && Scope->getScope() == LocB->getScope() &&
                     Scope->getLine() == LocB->getLine() &&
                     Scope->getColumn() == LocB->getColumn();
  if (LocA->getScope() != LocB->getScope() && !LastOperand)
    return false;
  return any_of(successors(&A), [&](const BasicBlock *S) {
    return is_contained(successors(&B), S);
  });
}

/// Counts for each comparison the others of its condition.
static void countOthers(std::vector<Comparison> &All) {
  EquivalenceClasses<const Instruction *> Conditions;
  for (const Comparison &C : All) {
    SmallVector<const Instruction *, 8> Work{C.Predicate};
    Conditions.insert(C.Predicate);
    while (!Work.empty()) {
      const auto *Br = dyn_cast<BranchInst>(Work.pop_back_val());
      if (!Br)
        continue;
      for (const BasicBlock *S : successors(Br)) {
        const BranchInst *Next = nextBranch(S);
        if (!Next || Next == Br || !sameCondition(*Br, *Next))
          continue;
        if (Conditions.findValue(Next) == Conditions.end())
          Work.push_back(Next);
        Conditions.unionSets(Br, Next);
      }
    }
  }
  for (Comparison &C : All)
    C.OtherThresholds = count_if(All, [&](const Comparison &O) {
      return &O != &C && Conditions.isEquivalent(C.Predicate, O.Predicate) &&
             (O.Compare != C.Compare || !C.Compare);
    });
}

GatheredResults GatherResults::run(Module &M, ModuleAnalysisManager &AM) {
  const ParameterUsage &Usage = AM.getResult<ParamUsageFinder>(M);
  const ParamCallFinder::Result &Reads = AM.getResult<ParamCallFinder>(M);
  const SliceResult &Slice = AM.getResult<BackwardPropagate>(M);
  const Options Opts = Options::fromCommandLine();
  UserSources Sources(Opts);
  GatheredResults R;
  for (const ParameterComparison &P : Usage.Comparisons) {
    Comparison C{};
    if (!nearest(P, Slice, C))
      continue;
    C.Compare = P.Compare;
    C.Threshold = P.Operand;
    C.FlagValue = P.Flag;
    C.IsOperand = P.IsOperand;
    C.How = P.How;
    C.Type = P.Flag                          ? Comparison::Flag
             : P.How.Kind == Transform::None ? Comparison::Parameter
                                             : Comparison::Derived;
    C.Reads.push_back(P.Read);
    const DILocation *Loc = C.place().getDebugLoc();
    if (!Loc) {
      ++R.WithoutDebugInfo;
      continue;
    }
    if (!Sources.has(Loc)) {
      ++R.OutsideSources;
      continue;
    }
    // A second read of the same parameter is the same comparison.
    auto Same = find_if(R.Comparisons, [&](const Comparison &O) {
      return O.Compare == C.Compare && O.Predicate == C.Predicate &&
             O.FlagValue == C.FlagValue && O.Threshold == C.Threshold &&
             Reads[O.Reads.front()].Name == Reads[P.Read].Name;
    });
    if (Same == R.Comparisons.end())
      R.Comparisons.push_back(std::move(C));
    else if (!is_contained(Same->Reads, P.Read))
      Same->Reads.push_back(P.Read);
  }
  countOthers(R.Comparisons);
  return R;
}

PreservedAnalyses GatherResultsPrinter::run(Module &M,
                                            ModuleAnalysisManager &AM) {
  const GatheredResults &R = AM.getResult<GatherResults>(M);
  const auto &Reads = AM.getResult<ParamCallFinder>(M);
  OS << "threshold predicate comparisons of " << M.getName() << ": "
     << R.Comparisons.size() << '\n';
  for (const Comparison &C : R.Comparisons)
    OS << "  " << C.typeName() << " '" << Reads[C.Reads.front()].Name
       << "' relation " << C.relation() << " as " << C.How.text()
       << " distance " << C.Slice.Distance << " others " << C.OtherThresholds
       << " in " << C.place().getFunction()->getName() << tpc::place(C.place())
       << '\n';
  return PreservedAnalyses::all();
}

} // namespace tpc
