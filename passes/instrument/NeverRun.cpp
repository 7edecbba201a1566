//===- NeverRun.cpp -------------------------------------------------------===//
#include "instrument/NeverRun.h"

#include "support/Functions.h"

#include "llvm/ADT/DenseMap.h"
#include "llvm/Analysis/ConstantFolding.h"
#include "llvm/IR/Constants.h"
#include "llvm/IR/Instructions.h"
#include "llvm/IR/Module.h"
#include "llvm/Transforms/Utils/BasicBlockUtils.h"
#include "llvm/Transforms/Utils/Local.h"

using namespace llvm;

namespace tpc {

namespace {

class FixedNumbers {
public:
  explicit FixedNumbers(const DataLayout &Layout) : Layout(Layout) {}

  /// The number that \p V always is because of what calls pass; null if that
  /// is not known.
  Constant *byCalls(Value *V) {
    IsPassed = false;
    Constant *Found = of(V, 0);
    return IsPassed ? Found : nullptr;
  }

private:
  Constant *of(Value *V, unsigned Depth);
  Constant *passedAs(Argument &Arg, unsigned Depth);

  const DataLayout &Layout;
  DenseMap<const Argument *, Constant *> Known;
  bool IsPassed = false; ///< an argument was met
};

} // namespace

/// The number that all calls pass as \p Arg.
Constant *FixedNumbers::passedAs(Argument &Arg, unsigned Depth) {
  IsPassed = true;
  // While it is searched, what a function hands on to itself says nothing.
  auto [It, New] = Known.try_emplace(&Arg, nullptr);
  if (!New)
    return It->second;
  Function *F = Arg.getParent();
  // Other code may call what the linker keeps visible.
  if (!F->hasLocalLinkage())
    return nullptr;
  Constant *All = nullptr;
  for (const Use &U : F->uses()) {
    auto *Call = dyn_cast<CallBase>(U.getUser());
    if (!Call || !Call->isCallee(&U) ||
        Call->getFunctionType() != F->getFunctionType())
      return nullptr;
    Value *Passed = Call->getArgOperand(Arg.getArgNo());
    if (Passed == &Arg)
      continue;
    Constant *One = of(Passed, Depth + 1);
    if (!One || (All && All != One))
      return nullptr;
    All = One;
  }
  return Known[&Arg] = All;
}

Constant *FixedNumbers::of(Value *V, unsigned Depth) {
  constexpr unsigned MaxDepth = 16; // Who writes longer conditions?
  if (auto *C = dyn_cast<Constant>(V))
    return isa<ConstantInt>(C) ? C : nullptr;
  if (Depth == MaxDepth || !V->getType()->isIntegerTy())
    return nullptr;
  if (auto *Arg = dyn_cast<Argument>(V))
    return passedAs(*Arg, Depth);
  auto *I = dyn_cast<Instruction>(V);
  if (!isa_and_nonnull<CastInst, ICmpInst, BinaryOperator>(I))
    return nullptr;
  SmallVector<Constant *, 2> Operands;
  for (Value *Operand : I->operands()) {
    Constant *One = of(Operand, Depth + 1);
    if (!One)
      return nullptr;
    Operands.push_back(One);
  }
  Constant *Folded =
      isa<ICmpInst>(I)
          ? ConstantFoldCompareInstOperands(cast<ICmpInst>(I)->getPredicate(),
                                            Operands[0], Operands[1], Layout)
          : ConstantFoldInstOperands(I, Operands, Layout);
  return dyn_cast_or_null<ConstantInt>(Folded);
}

void removeNeverRun(Module &M) {
  FixedNumbers Numbers(M.getDataLayout());
  for (Function &F : definedFunctions(M)) {
    bool Changed = false;
    for (BasicBlock &BB : F) {
      auto *Branch = dyn_cast<BranchInst>(BB.getTerminator());
      if (!Branch || !Branch->isConditional() ||
          isa<Constant>(Branch->getCondition()))
        continue;
      Constant *Fixed = Numbers.byCalls(Branch->getCondition());
      if (!Fixed)
        continue;
      Branch->setCondition(Fixed);
      Changed |= ConstantFoldTerminator(&BB);
    }
    if (Changed)
      EliminateUnreachableBlocks(F);
  }
}

} // namespace tpc
