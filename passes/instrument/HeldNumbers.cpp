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

/// The two operands of \p Call, described by \p Row: `this` and the first
/// argument, or the first two arguments. Null where there is none.
static std::pair<Value *, Value *> operandsOf(CallBase &Call, const Rule &Row) {
  if (Row.Method)
    return {objectOf(Call, Row), argument(Call, Row, 0)};
  return {argument(Call, Row, 0), argument(Call, Row, 1)};
}

/// Writes what \p Call, an assignment, a copy or one of `+=`, `-=` and `*=`,
/// does to its object \p To; \p Right is its operand.
static void exposeAssignment(CallBase &Call, StringRef Relation, Value *To,
                             Value *Right) {
  bool IsObject = Right->getType()->isPointerTy();
  if (IsObject == (Relation == "*=") ||
      (!IsObject && !Right->getType()->isDoubleTy()))
    return;
  Instruction *After = insertionPointAfter(Call);
  if (!After)
    return;
  IRBuilder<> B(&Call);
  B.SetCurrentDebugLocation(Call.getDebugLoc());
  Value *R = IsObject ? take(B, Right) : Right;
  Value *Number = Relation == "+="   ? B.CreateFAdd(take(B, To), R)
                  : Relation == "-=" ? B.CreateFSub(take(B, To), R)
                  : Relation == "*=" ? B.CreateFMul(take(B, To), R)
                                     : R;
  B.SetInsertPoint(After);
  B.SetCurrentDebugLocation(Call.getDebugLoc());
  put(B, To, Number);
}

static void expose(CallBase &Call, const Rule &Row) {
  auto [Left, Right] = operandsOf(Call, Row);
  if (!Left || !Right || !Left->getType()->isPointerTy())
    return;
  StringRef Relation = Row.Relation;
  if (is_contained({"copy", "+=", "-=", "*="}, Relation))
    return exposeAssignment(Call, Relation, Left, Right);
  bool IsScaled = Relation == "*" && Right->getType()->isDoubleTy();
  if (!IsScaled && !Right->getType()->isPointerTy())
    return;
  CmpInst::Predicate P = predicateOf(Relation);
  bool IsSum = Relation == "+", IsDifference = Relation == "-";
  bool IsArithmetic = IsSum || IsDifference || IsScaled;
  auto [After, Result] =
      IsArithmetic ? resultOf(Call) : std::pair(&Call, &Call);
  bool IsComparison =
      P != CmpInst::BAD_FCMP_PREDICATE && Call.getType()->isIntegerTy(1);
  if (!After || !(IsArithmetic || IsComparison))
    return;
  IRBuilder<> B(&Call);
  B.SetCurrentDebugLocation(Call.getDebugLoc());
  Value *L = take(B, Left), *R = IsScaled ? Right : take(B, Right);
  if (IsComparison) {
    Call.replaceAllUsesWith(B.CreateFCmp(P, L, R));
    return;
  }
  Value *Number = IsScaled ? B.CreateFMul(L, R)
                  : IsSum  ? B.CreateFAdd(L, R)
                           : B.CreateFSub(L, R);
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

Value *heldSeconds(IRBuilder<> &B, Value *Object, const CallBase &Operator,
                   const Rule &Row) {
  if (Row.Nanoseconds) {
    Value *Place =
        B.CreateConstGEP1_32(B.getInt8Ty(), Object, *Row.Nanoseconds);
    Value *Whole = B.CreateAlignedLoad(B.getInt64Ty(), Place, Align(8));
    return B.CreateFMul(B.CreateSIToFP(Whole, B.getDoubleTy()),
                        ConstantFP::get(B.getDoubleTy(), 1e-9));
  }
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
