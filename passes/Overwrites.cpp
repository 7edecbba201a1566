//===- Overwrites.cpp -----------------------------------------------------===//
#include "Overwrites.h"

#include "Idioms.h"

#include "llvm/ADT/SmallPtrSet.h"
#include "llvm/IR/InstIterator.h"

using namespace llvm;

namespace tpc {

const DominatorTree &Overwrites::dominators(const Function &F) {
  std::unique_ptr<DominatorTree> &Tree = Trees[&F];
  if (!Tree)
    Tree = std::make_unique<DominatorTree>(const_cast<Function &>(F));
  return *Tree;
}

/// The first store to the same variable that runs whenever \p Write has run and
/// no exception came in between; null where there is none.
const StoreInst *Overwrites::next(const Instruction &Write,
                                  const Value *Pointer) {
  const Function &F = *Write.getFunction();
  const BasicBlock *Block = Write.getParent();
  const StoreInst *First = nullptr;
  for (const Instruction &I : instructions(F)) {
    const auto *Store = dyn_cast<StoreInst>(&I);
    if (!Store || Store == &Write ||
        !isSameVariable(Store->getPointerOperand(), Pointer))
      continue;
    // The same predicates decide over both.
    const BasicBlock *Own = Store->getParent();
    if (Own != Block &&
        (Ifs.isControlledByEntry(Own) != Ifs.isControlledByEntry(Block) ||
         Ifs.controllers(Own) != Ifs.controllers(Block)))
      continue;
    const DominatorTree &Tree = dominators(F);
    if (Tree.dominates(&Write, Store) &&
        (!First || Tree.dominates(Store, First)))
      First = Store;
  }
  return First;
}

/// True where a call between \p Write and \p Next can run \p F.
bool Overwrites::runsBetween(const Function &F, const Instruction &Write,
                             const StoreInst &Next) {
  const DominatorTree &Tree = dominators(*Write.getFunction());
  SmallPtrSet<const Function *, 16> Seen;
  SmallVector<const Function *, 16> Work;
  auto Enter = [&](const Instruction &I) {
    if (const auto *Call = dyn_cast<CallBase>(&I))
      for (const Function *Callee : Calls.callees(*Call))
        if (Seen.insert(Callee).second)
          Work.push_back(Callee);
  };
  for (const Instruction &I : instructions(*Write.getFunction()))
    if (&I != &Write && Tree.dominates(&Write, &I) &&
        !Tree.dominates(&Next, &I))
      Enter(I);
  while (!Work.empty()) {
    const Function *Callee = Work.pop_back_val();
    if (Callee == &F)
      return true;
    for (const Instruction &I : instructions(*Callee))
      Enter(I);
  }
  return false;
}

void Overwrites::remove(const Instruction &Write, const Value *Pointer,
                        SmallVectorImpl<LoadInst *> &Loads) {
  if (Loads.empty())
    return;
  const StoreInst *Next = next(Write, Pointer);
  if (!Next)
    return;
  const Function &F = *Write.getFunction();
  // One answer a function is enough.
  SmallDenseMap<const Function *, bool, 4> Known;
  erase_if(Loads, [&](const LoadInst *Load) {
    if (Load->getFunction() == &F)
      return dominators(F).dominates(Next, Load);
    auto [It, New] = Known.try_emplace(Load->getFunction(), false);
    if (New)
      It->second = runsBetween(*Load->getFunction(), Write, *Next);
    return !It->second;
  });
}

} // namespace tpc
