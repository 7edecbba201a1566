//===- Conditions.cpp -----------------------------------------------------===//
#include "control/Conditions.h"

#include "control/IfStatements.h"

#include "llvm/ADT/SetVector.h"
#include "llvm/IR/CFG.h"
#include "llvm/IR/DebugInfoMetadata.h"
#include "llvm/IR/Instructions.h"

using namespace llvm;

namespace tpc {

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

/// True where \p B begins a statement in the block in which \p A is part of
/// another one, as `bool In = A && ...; if (In)`. Clang 19 gives both the scope
/// of the block; later ones give a statement's condition the scope of its own.
static bool nextStatement(const DILocation &A, const DILocation &B) {
  const auto *Own = dyn_cast<DILexicalBlock>(B.getScope());
  const auto *Around = dyn_cast<DILexicalBlock>(A.getScope());
  return Own && Own->getScope() == A.getScope() &&
         Own->getLine() == B.getLine() && Own->getColumn() == B.getColumn() &&
         !(Around && Around->getLine() == A.getLine());
}

/// True where \p A and \p B can belong to one condition, A before B. Clang
/// gives a statement's condition a scope of its own, in which all operands
/// stand but (in clang 19) the last; that one has the statement's place.
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

/// The ways out of \p Br, past blocks that only end a condition.
static SmallVector<const BasicBlock *, 2> waysOut(const BranchInst &Br) {
  SmallVector<const BasicBlock *, 2> Ways;
  for (const BasicBlock *S : successors(&Br)) {
    const BasicBlock *On = decidedWay(Br.getParent(), S);
    Ways.push_back(On ? On : S);
  }
  return Ways;
}

/// The branches that are operands of one `&&` or `||` with \p First and come
/// after it: of its statement, and with a way out that is also its own.
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
