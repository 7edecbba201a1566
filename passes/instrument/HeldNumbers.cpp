//===- HeldNumbers.cpp ----------------------------------------------------===//
#include "instrument/HeldNumbers.h"

#include "Rules.h"
#include "instrument/InstrumentBranches.h"
#include "support/Names.h"

#include "llvm/ADT/StringSwitch.h"
#include "llvm/IR/Module.h"

using namespace llvm;

namespace tpc {

static Value *take(IRBuilder<> &B, Value *Object) {
  Module &M = *B.GetInsertBlock()->getModule();
  FunctionCallee Take =
      M.getOrInsertFunction(TakeName, B.getDoubleTy(), B.getPtrTy());
  auto *F = cast<Function>(Take.getCallee());
  F->setDoesNotThrow();
  F->setMemoryEffects(MemoryEffects::argMemOnly(ModRefInfo::Ref));
  return B.CreateCall(Take, Object);
}

static void put(IRBuilder<> &B, Value *Object, Value *Number) {
  Module &M = *B.GetInsertBlock()->getModule();
  FunctionCallee Put = M.getOrInsertFunction(PutName, B.getVoidTy(),
                                             B.getPtrTy(), B.getDoubleTy());
  cast<Function>(Put.getCallee())->setDoesNotThrow();
  B.CreateCall(Put, {Object, Number});
}

static CmpInst::Predicate predicateOf(StringRef Relation) {
  return StringSwitch<CmpInst::Predicate>(Relation)
      .Case("==", CmpInst::FCMP_OEQ)
      .Case("!=", CmpInst::FCMP_UNE)
      .Case("<", CmpInst::FCMP_OLT)
      .Case("<=", CmpInst::FCMP_OLE)
      .Case(">", CmpInst::FCMP_OGT)
      .Case(">=", CmpInst::FCMP_OGE)
      .Default(CmpInst::BAD_FCMP_PREDICATE);
}

/// Where the object that \p Call returns is complete, and the pointer to it;
/// null if that is not known.
static std::pair<Instruction *, Value *> resultOf(CallBase &Call) {
  if (Call.hasStructRetAttr())
    return {insertionPointAfter(Call), Call.getArgOperand(0)};
  // An object of eight bytes is returned in a register.
  auto *Store =
      Call.hasOneUse() ? dyn_cast<StoreInst>(*Call.user_begin()) : nullptr;
  if (!Store || Store->getValueOperand() != &Call)
    return {nullptr, nullptr};
  return {Store->getNextNode(),
          Store->getPointerOperand()->stripPointerCasts()};
}

static void expose(CallBase &Call, const Rule &Row) {
  Value *Left = objectOf(Call, Row), *Right = argument(Call, Row, 0);
  if (!Left || !Right || !Left->getType()->isPointerTy() ||
      !Right->getType()->isPointerTy())
    return;
  CmpInst::Predicate P = predicateOf(Row.Relation);
  bool IsSum = Row.Relation == "+", IsDifference = Row.Relation == "-";
  auto [After, Result] =
      IsSum || IsDifference ? resultOf(Call) : std::pair(&Call, &Call);
  bool IsComparison =
      P != CmpInst::BAD_FCMP_PREDICATE && Call.getType()->isIntegerTy(1);
  if (!After || !(IsSum || IsDifference || IsComparison))
    return;
  IRBuilder<> B(&Call);
  B.SetCurrentDebugLocation(Call.getDebugLoc());
  Value *L = take(B, Left), *R = take(B, Right);
  if (IsComparison) {
    Call.replaceAllUsesWith(B.CreateFCmp(P, L, R));
    return;
  }
  Value *Number = IsSum ? B.CreateFAdd(L, R) : B.CreateFSub(L, R);
  B.SetInsertPoint(After);
  B.SetCurrentDebugLocation(Call.getDebugLoc());
  put(B, Result, Number);
}

void exposeHeldNumbers(Module &M, const RuleMatches &Rules) {
  SmallVector<std::pair<CallBase *, const Rule *>, 16> Calls;
  forEachCall(M, Rules, Rule::Held, [&](CallBase &Call, const Rule &Row) {
    Calls.push_back({&Call, &Row});
  });
  for (auto [Call, Row] : Calls)
    expose(*Call, *Row);
}

Value *heldSeconds(IRBuilder<> &B, Value *Object, const CallBase &Operator) {
  auto Part = [&](unsigned Index) {
    return B.CreateAlignedLoad(
        B.getInt32Ty(), B.CreateConstGEP1_32(B.getInt32Ty(), Object, Index),
        Align(4));
  };
  const Function *F = Operator.getCalledFunction();
  bool IsSigned =
      F && StringRef(qualifiedName(F->getName())).contains("Duration");
  Value *Whole = IsSigned ? B.CreateSIToFP(Part(0), B.getDoubleTy())
                          : B.CreateUIToFP(Part(0), B.getDoubleTy());
  Value *Rest = B.CreateSIToFP(Part(1), B.getDoubleTy());
  return B.CreateFAdd(
      Whole, B.CreateFMul(Rest, ConstantFP::get(B.getDoubleTy(), 1e-9)));
}

} // namespace tpc
