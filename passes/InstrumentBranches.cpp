//===- InstrumentBranches.cpp ---------------------------------------------===//
#include "InstrumentBranches.h"

#include "Guard.h"
#include "IfStatements.h"
#include "Print.h"

#include "llvm/IR/IRBuilder.h"
#include "llvm/IR/Instructions.h"
#include "llvm/IR/Verifier.h"
#include "llvm/Support/raw_ostream.h"

using namespace llvm;

namespace tpc {

std::optional<Report> planReport(const Comparison &C, bool IsUnsigned,
                                 const AnalysedModule &Analysed) {
  Report R;
  R.Key = C.Key;
  auto *Predicate = cast_or_null<Instruction>(Analysed.original(C.Predicate));
  if (!Predicate)
    return std::nullopt;
  if (!C.Compare) {
    Value *Flag = C.FlagValue == conditionOf(*C.Predicate)
                      ? conditionOf(*Predicate)
                      : Analysed.original(C.FlagValue);
    if (!Flag || Flag->getType()->isVectorTy() || (!C.Direct && !C.IsOperand))
      return std::nullopt;
    R.Before = Predicate;
    R.Result = conditionOf(*Predicate);
    if (C.IsOperand) {
      R.Before = cast<Instruction>(Flag)->getNextNode();
      R.Result = Flag;
    }
    // An integer that stands as a condition is compared with zero: the value
    // itself says more than the outcome.
    if (auto *NotZero = dyn_cast<CmpInst>(Flag))
      Flag = NotZero->getOperand(isa<Constant>(NotZero->getOperand(0)) ? 1 : 0);
    R.Compared = R.Threshold = Flag;
    R.Outcome = R.Result;
    R.Signed =
        !Flag->getType()->isIntegerTy(1) && !Flag->getType()->isIntegerTy(8);
    return R;
  }
  // Vectors are compared element by element: that is not one outcome.
  auto *Compare = cast_or_null<CmpInst>(Analysed.original(C.Compare));
  if (!Compare || Compare->getType()->isVectorTy())
    return std::nullopt;
  R.Threshold = Compare->getOperand(C.Threshold);
  R.Compared = Compare->getOperand(1 - C.Threshold);
  R.Outcome = Compare;
  // Equality does not say how its operands are to be read; what was widened
  // with zeros was not negative.
  R.Signed = !Compare->isUnsigned() &&
             !(Compare->isEquality() &&
               (IsUnsigned || any_of(Compare->operands(), [](const Use &U) {
                  return isa<ZExtInst>(U);
                })));
  R.Before = C.Direct ? Predicate : Compare->getNextNode();
  R.Result = C.Direct ? conditionOf(*Predicate) : Compare;
  return R;
}

/// \p V as a double.
static Value *toDouble(IRBuilder<> &B, Value *V, bool Signed) {
  Type *Double = B.getDoubleTy();
  Type *T = V->getType();
  if (T->isFloatingPointTy())
    return B.CreateFPCast(V, Double);
  if (!T->isIntegerTy())
    return ConstantFP::getNaN(Double);
  return Signed && !T->isIntegerTy(1) ? B.CreateSIToFP(V, Double)
                                      : B.CreateUIToFP(V, Double);
}

static Value *toBool(IRBuilder<> &B, Value *V) {
  Type *T = V->getType();
  if (T->isIntegerTy(1))
    return V;
  return T->isFloatingPointTy() ? B.CreateFCmpUNE(V, ConstantFP::get(T, 0))
                                : B.CreateICmpNE(V, Constant::getNullValue(T));
}

/// `void log_one(char *key, bool result, double cmp, double thresh, bool res)`
static FunctionCallee logFunction(Module &M) {
  LLVMContext &Ctx = M.getContext();
  Type *Bool = Type::getInt1Ty(Ctx), *Double = Type::getDoubleTy(Ctx);
  auto *T = FunctionType::get(
      Type::getVoidTy(Ctx),
      {PointerType::getUnqual(Ctx), Bool, Double, Double, Bool}, false);
  FunctionCallee Callee = M.getOrInsertFunction("_Z7log_onePcbddb", T);
  if (auto *F = dyn_cast<Function>(Callee.getCallee());
      F && F->isDeclaration()) {
    F->addParamAttr(1, Attribute::ZExt);
    F->addParamAttr(4, Attribute::ZExt);
    F->setDoesNotThrow();
  }
  return Callee;
}

std::string insertReports(Module &M, ArrayRef<Report> Reports) {
  if (Reports.empty())
    return "";
  bool WasThere = M.getFunction("_Z7log_onePcbddb");
  FunctionCallee Log = logFunction(M);
  SmallVector<Instruction *, 0> Inserted;
  StringMap<GlobalVariable *> Keys;
  Instruction *Above = nullptr, *Before = nullptr;
  auto Collect = [&] {
    for (Instruction *I = Before ? Before->getPrevNode() : nullptr; I != Above;
         I = I->getPrevNode())
      Inserted.push_back(I);
    Above = Before = nullptr;
  };
  auto Insert = [&](const Report &R) {
    GlobalVariable *&Key = Keys[R.Key];
    if (!Key) {
      Constant *Text = ConstantDataArray::getString(M.getContext(), R.Key);
      Key = new GlobalVariable(M, Text->getType(), /*isConstant=*/true,
                               GlobalValue::PrivateLinkage, Text, "tpc.key");
      Key->setUnnamedAddr(GlobalValue::UnnamedAddr::Global);
    }
    Above = R.Before->getPrevNode();
    Before = R.Before;
    IRBuilder<> B(R.Before);
    B.SetCurrentDebugLocation(R.Before->getDebugLoc());
    CallInst *Call = B.CreateCall(
        Log, {Key, toBool(B, R.Result), toDouble(B, R.Compared, R.Signed),
              toDouble(B, R.Threshold, R.Signed), toBool(B, R.Outcome)});
    Call->addParamAttr(1, Attribute::ZExt);
    Call->addParamAttr(4, Attribute::ZExt);
    Collect();
  };
  std::string Why;
  raw_string_ostream OS(Why);
  if (runGuarded([&] { for_each(Reports, Insert); })) {
    if (!verifyModule(M, &OS))
      return "";
    Why = "the instrumented module does not verify: " +
          StringRef(Why).split('\n').first.str();
  } else {
    Collect();
    Why = "the instrumentation crashed";
  }
  for (Instruction *I : reverse(Inserted))
    I->dropAllReferences();
  for (Instruction *I : Inserted)
    I->eraseFromParent();
  for (auto &[Text, Key] : Keys)
    Key->eraseFromParent();
  if (auto *F = dyn_cast<Function>(Log.getCallee()); F && !WasThere)
    F->eraseFromParent();
  return Why;
}

PreservedAnalyses InstrumentBranchesPrinter::run(Module &M,
                                                 ModuleAnalysisManager &AM) {
  const GatheredResults &R = AM.getResult<GatherResults>(M);
  OS << "reports of " << M.getName() << '\n';
  for (const Comparison &C : R.Comparisons)
    OS << "  " << (C.Direct ? "before the predicate" : "where it is evaluated")
       << tpc::place(C.Direct ? *C.Predicate : C.place()) << " of the "
       << C.typeName() << tpc::place(C.place()) << '\n';
  return PreservedAnalyses::all();
}

} // namespace tpc
