//===- Prepare.cpp --------------------------------------------------------===//
#include "Prepare.h"

#include "llvm/IR/InstIterator.h"
#include "llvm/IR/Instructions.h"
#include "llvm/IR/Operator.h"
#include "llvm/Passes/PassBuilder.h"
#include "llvm/Transforms/Scalar/SROA.h"
#include "llvm/Transforms/Utils/Cloning.h"

using namespace llvm;

namespace tpc {

/// Turns the local variables of \p M into values. The flow graph stays.
static void promote(Module &M) {
  PassBuilder PB;
  LoopAnalysisManager LAM;
  FunctionAnalysisManager FAM;
  CGSCCAnalysisManager CGAM;
  ModuleAnalysisManager MAM;
  PB.registerModuleAnalyses(MAM);
  PB.registerCGSCCAnalyses(CGAM);
  PB.registerFunctionAnalyses(FAM);
  PB.registerLoopAnalyses(LAM);
  PB.crossRegisterProxies(LAM, FAM, CGAM, MAM);
  ModulePassManager MPM;
  MPM.addPass(
      createModuleToFunctionPassAdaptor(SROAPass(SROAOptions::PreserveCFG)));
  MPM.run(M, MAM);
}

/// True where \p I only keeps a local variable in memory: promotion takes it
/// away, and what takes its place stands for something else.
static bool isLocalMemory(const Instruction &I) {
  const Value *Pointer = getLoadStorePointerOperand(&I);
  if (!Pointer)
    return isa<AllocaInst>(I);
  while (const auto *GEP = dyn_cast<GEPOperator>(Pointer))
    Pointer = GEP->getPointerOperand();
  return isa<AllocaInst>(Pointer);
}

AnalysedModule::AnalysedModule(Module &M) : Original(M) {
  bool Unoptimised = any_of(M, [](const Function &F) {
    return F.hasFnAttribute(Attribute::OptimizeNone);
  });
  if (!Unoptimised) {
    promote(M);
    return;
  }
  ValueToValueMapTy Map;
  Copy = CloneModule(M, Map);
  for (Function &F : *Copy)
    F.removeFnAttr(Attribute::OptimizeNone);
  promote(*Copy);
  // The map follows what promotion replaces; in the order of the program the
  // instruction itself comes before those that it stands in for.
  for (Function &F : M)
    for (Instruction &I : instructions(F))
      if (!isLocalMemory(I))
        if (auto *C = dyn_cast_or_null<Instruction>(Map.lookup(&I));
            C && C->getOpcode() == I.getOpcode())
          Back.try_emplace(C, &I);
}

Value *AnalysedModule::original(Value *V) const {
  if (!Copy || isa<Constant>(V))
    return V;
  return Back.lookup(V);
}

PreservedAnalyses PreparePass::run(Module &M, ModuleAnalysisManager &) {
  for (Function &F : M)
    F.removeFnAttr(Attribute::OptimizeNone);
  promote(M);
  return PreservedAnalyses::none();
}

} // namespace tpc
