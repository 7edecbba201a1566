//===- CallNumbers.cpp ----------------------------------------------------===//
#include "instrument/CallNumbers.h"

#include "llvm/ADT/DenseMap.h"
#include "llvm/IR/Constants.h"
#include "llvm/IR/InstIterator.h"
#include "llvm/IR/Metadata.h"

using namespace llvm;

namespace tpc {

static constexpr StringLiteral KindName = "tpc.call";

static void set(CallBase &Call, unsigned Number) {
  LLVMContext &C = Call.getContext();
  Metadata *As =
      ConstantAsMetadata::get(ConstantInt::get(Type::getInt32Ty(C), Number));
  Call.setMetadata(KindName, MDNode::get(C, As));
}

unsigned CallNumbers::of(const CallBase &Call) {
  const MDNode *N = Call.getMetadata(KindName);
  return N ? mdconst::extract<ConstantInt>(N->getOperand(0))->getZExtValue()
           : 0;
}

void CallNumbers::number(Module &M) {
  for (Function &F : M)
    for (Instruction &I : instructions(F))
      if (auto *Call = dyn_cast<CallBase>(&I))
        if (const Function *Callee = Call->getCalledFunction();
            Callee && !Callee->isDeclaration())
          set(*Call, ++Last);
}

void CallNumbers::renew(Function &There, Function &Here) {
  DenseMap<unsigned, unsigned> New;
  for (Instruction &I : instructions(There))
    if (auto *Call = dyn_cast<CallBase>(&I))
      if (unsigned Number = of(*Call))
        set(*Call, New[Number] = ++Last);
  for (Instruction &I : instructions(Here))
    if (auto *Call = dyn_cast<CallBase>(&I))
      if (auto It = New.find(of(*Call)); It != New.end())
        set(*Call, It->second);
}

} // namespace tpc
