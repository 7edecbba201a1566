//===- Conditions.cpp -----------------------------------------------------===//
#include "control/Conditions.h"

#include "control/IfStatements.h"

#include "llvm/ADT/SetVector.h"
#include "llvm/IR/CFG.h"
#include "llvm/IR/DebugInfoMetadata.h"
#include "llvm/IR/Instructions.h"

using namespace llvm;

namespace tpc {

/// The next conditional branch reached from \p BB without passing another one.
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

/// True if \p B begins a new statement in the block in which \p A is part of an
/// earlier one, as in `bool In = A && ...; if (In)`. Clang 19 gives both the
/// scope of the block; later versions give the condition of a statement its own
/// scope.
static bool nextStatement(const DILocation &A, const DILocation &B) {
  const auto *Own = dyn_cast<DILexicalBlock>(B.getScope());
  const auto *Around = dyn_cast<DILexicalBlock>(A.getScope());
  return Own && Own->getScope() == A.getScope() &&
         Own->getLine() == B.getLine() && Own->getColumn() == B.getColumn() &&
         !(Around && Around->getLine() == A.getLine());
}

/// True if \p A and \p B can belong to one condition, A before B. Clang gives
/// the condition of a statement a scope of its own that holds all operands. In
/// clang 19 the last operand is an exception: it has the location of the
/// statement.
static bool sameStatement(const BranchInst &A, const BranchInst &B) {
  const DILocation *LocA = A.getDebugLoc(), *LocB = B.getDebugLoc();
  if (!LocA || !LocB)
    return false;
  if (nextStatement(*LocA, *LocB))
    return true;
  const auto *Scope = dyn_cast<DILexicalBlock>(LocA->getScope());
  return LocA->getScope() == LocB->getScope() ||
         (Scope && Scope->getScope() == LocB->getScope() &&
          Scope->getLine() == LocB->getLine() &&
          Scope->getColumn() == LocB->getColumn());
}

/// The successors of \p Br, past blocks that only end a condition.
static SmallVector<const BasicBlock *, 2> waysOut(const BranchInst &Br) {
  SmallVector<const BasicBlock *, 2> Ways;
  for (const BasicBlock *S : successors(&Br)) {
    const BasicBlock *On = decidedWay(Br.getParent(), S);
    Ways.push_back(On ? On : S);
  }
  return Ways;
}

/// The branches after \p First that are operands of the same `&&` or `||`: they
/// belong to the same statement and share a successor with it.
static SmallVector<const BranchInst *, 4>
sameCondition(const BranchInst &First) {
  SmallVector<const BranchInst *, 4> Found;
  SmallSetVector<const BranchInst *, 8> Chain;
  Chain.insert(&First);
  for (unsigned N = 0; N < Chain.size() && N < 16; ++N)
    for (const BasicBlock *S : successors(Chain[N])) {
      const BranchInst *Next = nextBranch(S);
      if (Next && sameStatement(First, *Next))
        Chain.insert(Next);
    }
  SmallVector<const BasicBlock *, 2> Own = waysOut(First);
  for (const BranchInst *Br : drop_begin(Chain))
    if (any_of(waysOut(*Br),
               [&](const BasicBlock *W) { return is_contained(Own, W); }))
      Found.push_back(Br);
  return Found;
}

Conditions::Conditions(ArrayRef<const Instruction *> Predicates) {
  SmallSetVector<const BranchInst *, 8> Work;
  for (const Instruction *Predicate : Predicates) {
    Classes.insert(Predicate);
    if (const auto *Br = dyn_cast<BranchInst>(Predicate))
      Work.insert(Br);
  }
  for (unsigned N = 0; N < Work.size(); ++N)
    for (const BranchInst *Br : sameCondition(*Work[N])) {
      Classes.unionSets(Work[N], Br);
      Work.insert(Br);
    }
}

} // namespace tpc
