//===- Idioms.cpp ---------------------------------------------------------===//
#include "params/Idioms.h"

#include "memory/Variables.h"
#include "params/Configured.h"
#include "params/Transform.h"

#include "llvm/ADT/SmallPtrSet.h"
#include "llvm/IR/GlobalVariable.h"
#include "llvm/IR/IntrinsicInst.h"
#include "llvm/IR/Operator.h"
#include "llvm/IR/PatternMatch.h"

using namespace llvm;

namespace tpc {

bool isSameVariable(const Value *A, const Value *B) {
  auto AtBeginning = [](const Value *V) {
    const auto *GEP = dyn_cast<GEPOperator>(V);
    for (; GEP && GEP->hasAllZeroIndices(); GEP = dyn_cast<GEPOperator>(V))
      V = GEP->getPointerOperand();
    return V;
  };
  A = AtBeginning(A);
  B = AtBeginning(B);
  if (A == B)
    return true;
  const auto *L = dyn_cast<LoadInst>(A), *M = dyn_cast<LoadInst>(B);
  if (L && M)
    return isSameVariable(L->getPointerOperand(), M->getPointerOperand());
  const auto *G = dyn_cast<GEPOperator>(A), *H = dyn_cast<GEPOperator>(B);
  return G && H && G->getSourceElementType() == H->getSourceElementType() &&
         equal(G->indices(), H->indices()) &&
         isSameVariable(G->getPointerOperand(), H->getPointerOperand());
}

/// Calls \p Found with the values from which \p V is computed, until it returns
/// true; true if it did.
static bool anySource(const Value *V, function_ref<bool(const Value *)> Found) {
  constexpr unsigned Most = 64; // More are no formula that somebody wrote.
  SmallVector<const Value *, 8> Work{V};
  SmallPtrSet<const Value *, 16> Seen;
  while (!Work.empty() && Seen.size() < Most) {
    const Value *Next = Work.pop_back_val();
    if (!Seen.insert(Next).second)
      continue;
    if (Found(Next))
      return true;
    const auto *Call = dyn_cast<IntrinsicInst>(Next);
    if (isa<BinaryOperator, UnaryOperator, CastInst, PHINode, SelectInst,
            FreezeInst>(Next) ||
        (Call && Call->doesNotAccessMemory()))
      append_range(Work, cast<User>(Next)->operands());
  }
  return false;
}

bool isComputedFrom(const Value *V, const Value *Source) {
  const auto *Load = dyn_cast<LoadInst>(Source);
  return anySource(V, [&](const Value *From) {
    const auto *Other = dyn_cast<LoadInst>(From);
    return From == Source || (Load && Other &&
                              isSameVariable(Load->getPointerOperand(),
                                             Other->getPointerOperand()));
  });
}

/// True for arithmetic that gives the next value of a series: not by a constant
/// whole number.
static bool isStep(const Value &V) {
  if (const auto *Call = dyn_cast<IntrinsicInst>(&V))
    return isMultiplyAdd(*Call);
  const auto *Op = dyn_cast<BinaryOperator>(&V);
  if (!Op)
    return false;
  switch (Op->getOpcode()) {
  case Instruction::FAdd:
  case Instruction::FSub:
  case Instruction::FMul:
  case Instruction::FDiv:
    return true;
  case Instruction::Add:
  case Instruction::Sub:
  case Instruction::Mul:
    return none_of(Op->operands(),
                   [](const Use &U) { return isa<Constant>(U); });
  default:
    return false;
  }
}

bool isStepped(const PHINode &Merge) {
  // A step anywhere on the way from the phi back to itself.
  return anySource(&Merge, [&](const Value *Step) {
    return isStep(*Step) && isComputedFrom(Step, &Merge);
  });
}

bool isMovedOn(const StoreInst &Store) {
  return anySource(Store.getValueOperand(), [&](const Value *From) {
    const auto *Load = dyn_cast<LoadInst>(From);
    return Load &&
           isSameVariable(Load->getPointerOperand(), Store.getPointerOperand());
  });
}

namespace {

/// One of the two values; with Pointed, the value that a pointer leads to.
struct Side {
  const Value *V;
  bool Pointed;
};

/// A merge of two values, and the comparison that chooses: True if the
/// comparison holds.
struct Merged {
  const CmpInst *Compare;
  Side True, False;
  // If it takes the smaller or the larger of the two:
  bool Largest = false;
  bool Swapped = false; ///< the first operand of Compare is False
};

} // namespace

/// The only constant that the local variable \p Pointer ever holds.
static const Value *pointedConstant(const Value *Pointer) {
  if (const auto *Global = dyn_cast<GlobalVariable>(Pointer))
    return Global->isConstant() && Global->hasInitializer()
               ? Global->getInitializer()
               : nullptr;
  if (!isa<AllocaInst>(Pointer))
    return nullptr;
  const Value *Found = nullptr;
  for (const User *U : Pointer->users()) {
    const auto *Store = dyn_cast<StoreInst>(U);
    if (Store && Store->getPointerOperand() == Pointer) {
      if (Found || !isa<Constant>(Store->getValueOperand()))
        return nullptr;
      Found = Store->getValueOperand();
    } else if (isa<CallBase>(U) &&
               !cast<Instruction>(U)->isLifetimeStartOrEnd())
      return nullptr;
  }
  return Found;
}

static std::optional<double> constantOf(const Side &S) {
  const Value *V = S.Pointed ? pointedConstant(S.V) : S.V;
  return V ? constantNumber(V) : std::nullopt;
}

/// True if \p V has the same text as the value of \p S: nothing in the idiom
/// changes a variable in between.
static bool isSide(const Value *V, const Side &S) {
  if (auto C = constantOf(S))
    return constantNumber(V) == C ||
           (S.Pointed && isa<LoadInst>(V) &&
            isSameVariable(cast<LoadInst>(V)->getPointerOperand(), S.V));
  const auto *Load = dyn_cast<LoadInst>(V);
  if (S.Pointed)
    return Load && isSameVariable(Load->getPointerOperand(), S.V);
  const auto *Own = dyn_cast<LoadInst>(S.V);
  return V == S.V ||
         (Load && Own &&
          isSameVariable(Load->getPointerOperand(), Own->getPointerOperand()));
}

/// The branch that decides by which of its two edges a phi is entered, and the
/// index of the edge taken if its condition holds.
static std::optional<std::pair<const BranchInst *, unsigned>>
deciderOf(const PHINode &Phi) {
  if (Phi.getNumIncomingValues() != 2)
    return std::nullopt;
  // The first block that belongs only to this edge; null if the deciding block
  // leads directly to the phi.
  auto Decider = [](const BasicBlock *BB, const BasicBlock *&First) {
    First = nullptr;
    const auto *Br = dyn_cast<BranchInst>(BB->getTerminator());
    for (unsigned Steps = 0; Br && !Br->isConditional() && Steps < 4; ++Steps) {
      First = BB;
      BB = BB->getSinglePredecessor();
      Br = BB ? dyn_cast<BranchInst>(BB->getTerminator()) : nullptr;
    }
    return Br && Br->isConditional() ? Br : nullptr;
  };
  const BasicBlock *First0, *First1;
  const BranchInst *Br = Decider(Phi.getIncomingBlock(0), First0);
  if (!Br || Br != Decider(Phi.getIncomingBlock(1), First1))
    return std::nullopt;
  const BasicBlock *Way0 = First0 ? First0 : Phi.getParent();
  const BasicBlock *Way1 = First1 ? First1 : Phi.getParent();
  if (Way0 == Way1)
    return std::nullopt;
  return std::pair(Br, Br->getSuccessor(0) == Way0 ? 0U : 1U);
}

static std::optional<Merged> mergedBy(const Instruction &I, bool Pointed) {
  if (const auto *Select = dyn_cast<SelectInst>(&I)) {
    const auto *Compare = dyn_cast<CmpInst>(Select->getCondition());
    if (!Compare)
      return std::nullopt;
    return Merged{Compare,
                  {Select->getTrueValue(), Pointed},
                  {Select->getFalseValue(), Pointed}};
  }
  const auto *Phi = dyn_cast<PHINode>(&I);
  auto Decider = Phi ? deciderOf(*Phi) : std::nullopt;
  if (!Decider)
    return std::nullopt;
  auto [Br, True] = *Decider;
  const auto *Compare = dyn_cast<CmpInst>(Br->getCondition());
  if (!Compare)
    return std::nullopt;
  return Merged{Compare,
                {Phi->getIncomingValue(True), Pointed},
                {Phi->getIncomingValue(1 - True), Pointed}};
}

/// The merge that \p Merge is, or is loaded through, if it takes the smaller or
/// the larger of two values.
static std::optional<Merged> orderedMerge(const Instruction &Merge) {
  const auto *Load = dyn_cast<LoadInst>(&Merge);
  const auto *Merging =
      Load ? dyn_cast<Instruction>(Load->getPointerOperand()) : &Merge;
  if (!Merging || Merging->getType()->isPointerTy() != (Load != nullptr))
    return std::nullopt;
  std::optional<Merged> M = mergedBy(*Merging, Load != nullptr);
  if (!M)
    return std::nullopt;
  const Value *L = M->Compare->getOperand(0), *R = M->Compare->getOperand(1);
  CmpInst::Predicate P = M->Compare->getPredicate();
  if (isSide(L, M->False) && isSide(R, M->True)) {
    P = CmpInst::getSwappedPredicate(P);
    M->Swapped = true;
  } else if (!isSide(L, M->True) || !isSide(R, M->False)) {
    return std::nullopt;
  }
  // The first value is chosen if it is less, or if it is greater.
  switch (P) {
  case CmpInst::ICMP_SLT:
  case CmpInst::ICMP_SLE:
  case CmpInst::ICMP_ULT:
  case CmpInst::ICMP_ULE:
  case CmpInst::FCMP_OLT:
  case CmpInst::FCMP_OLE:
    return M;
  case CmpInst::ICMP_SGT:
  case CmpInst::ICMP_SGE:
  case CmpInst::ICMP_UGT:
  case CmpInst::ICMP_UGE:
  case CmpInst::FCMP_OGT:
  case CmpInst::FCMP_OGE:
    M->Largest = true;
    return M;
  default:
    return std::nullopt;
  }
}

std::optional<Choice> choiceOf(const Instruction &Merge) {
  std::optional<Merged> M = orderedMerge(Merge);
  if (!M)
    return std::nullopt;
  auto IfTrue = constantOf(M->True), IfFalse = constantOf(M->False);
  if (IfTrue.has_value() == IfFalse.has_value())
    return std::nullopt;
  return Choice{M->Largest, IfTrue ? *IfTrue : *IfFalse};
}

/// Adds the values of which \p M takes one. A value that is reached by a
/// pointer may be the smaller or larger of others.
static void addLimited(const Merged &M, SmallVectorImpl<Limited> &Out) {
  for (bool IsTrue : {true, false}) {
    const Side &S = IsTrue ? M.True : M.False;
    const Value *Compared = M.Compare->getOperand(IsTrue == M.Swapped ? 1 : 0);
    const auto *Load = dyn_cast<LoadInst>(Compared);
    std::optional<Merged> Inner =
        S.Pointed && Load && Load->getPointerOperand() == S.V
            ? orderedMerge(*Load)
            : std::nullopt;
    if (Inner)
      addLimited(*Inner, Out);
    else
      Out.push_back({S.V, Compared});
  }
}

SmallVector<Limited, 3> limitedBy(const Instruction &Merge) {
  SmallVector<Limited, 3> Found;
  if (std::optional<Merged> M = orderedMerge(Merge))
    addLimited(*M, Found);
  return Found;
}

/// True if \p A and \p B are computed in the same way from the same variables,
/// which no sensible program changes in between: in one block, or \p Across the
/// blocks of an idiom.
static bool isSameValue(const Value *A, const Value *B, bool Across = false,
                        unsigned Depth = 0) {
  if (A == B)
    return true;
  const auto *I = dyn_cast<Instruction>(A), *J = dyn_cast<Instruction>(B);
  if (!I || !J || Depth == 4 || (!Across && I->getParent() != J->getParent()) ||
      !I->isSameOperationAs(J))
    return false;
  if (const auto *Load = dyn_cast<LoadInst>(I))
    return isSameVariable(Load->getPointerOperand(),
                          cast<LoadInst>(J)->getPointerOperand());
  return (isa<BinaryOperator>(I) || isa<CastInst>(I) ||
          isa<UnaryOperator>(I)) &&
         all_of(zip(I->operands(), J->operands()), [&](auto Pair) {
           return isSameValue(std::get<0>(Pair), std::get<1>(Pair), Across,
                              Depth + 1);
         });
}

const Value *limitedBy(const StoreInst &Store) {
  const BasicBlock *Before = Store.getParent()->getSinglePredecessor();
  const auto *Br =
      Before ? dyn_cast<BranchInst>(Before->getTerminator()) : nullptr;
  const auto *Compare = Br && Br->isConditional()
                            ? dyn_cast<CmpInst>(Br->getCondition())
                            : nullptr;
  if (!Compare || Compare->isEquality())
    return nullptr;
  for (unsigned N : {0, 1})
    // A float is compared as the double that it becomes.
    if (isSameValue(stripCasts(Compare->getOperand(N)),
                    stripCasts(Store.getValueOperand()), /*Across=*/true))
      return Compare->getOperand(1 - N);
  return nullptr;
}

int squareOf(const Instruction &I) {
  using namespace PatternMatch;
  const auto *Fma = dyn_cast<IntrinsicInst>(&I);
  if (I.getOpcode() != Instruction::FMul && I.getOpcode() != Instruction::Mul &&
      !(Fma && Fma->getIntrinsicID() == Intrinsic::fmuladd))
    return 0;
  const Value *L = I.getOperand(0), *R = I.getOperand(1);
  int Sign = 1;
  for (const Value **Side : {&L, &R}) {
    const Value *Inner;
    auto Negated = m_CombineOr(m_FNeg(m_Value(Inner)), m_Neg(m_Value(Inner)));
    if (match(*Side, Negated)) {
      *Side = Inner;
      Sign = -Sign;
    }
  }
  return isSameValue(L, R) ? Sign : 0;
}

} // namespace tpc
