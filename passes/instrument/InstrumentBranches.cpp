//===- InstrumentBranches.cpp ---------------------------------------------===//
#include "instrument/InstrumentBranches.h"

#include "control/IfStatements.h"
#include "instrument/HeldNumbers.h"
#include "support/Compat.h"
#include "support/Guard.h"
#include "support/Print.h"

#include "llvm/ADT/Statistic.h"
#include "llvm/IR/IRBuilder.h"
#include "llvm/IR/Instructions.h"
#include "llvm/IR/Verifier.h"
#include "llvm/Support/raw_ostream.h"
#include "llvm/Transforms/Utils/ModuleUtils.h"

using namespace llvm;

namespace tpc {

#define DEBUG_TYPE "tpc-instrument-branches"
STATISTIC(NumReports, "Reports inserted");

/// `void log_one(char *key, bool result, double cmp, double thresh, bool res)`
static constexpr StringLiteral LogName = "_Z7log_onePcbddb";

/// The same with `const void *object` at the end. Weak: a program's own log_one
/// gets all reports.
static constexpr StringLiteral LogOfName = "_Z10log_one_ofPcbddbPKv";

Instruction *insertionPointAfter(Instruction &I) {
  if (auto *Invoke = dyn_cast<InvokeInst>(&I)) {
    BasicBlock *Next = Invoke->getNormalDest();
    return Next->getSinglePredecessor() ? &*Next->getFirstInsertionPt()
                                        : nullptr;
  }
  if (isa<PHINode>(I))
    return &*I.getParent()->getFirstInsertionPt();
  return I.getNextNode();
}

/// \p V without negations. Clang inverts the branches of `if (!(a < b))`, and
/// an outcome that is stored negated must be reported in the same way.
static Value *withoutNegation(Value *V) {
  for (Value *Next = V; auto *I = dyn_cast<Instruction>(Next);) {
    bool Negates = I->getOpcode() == Instruction::Xor &&
                   isa<ConstantInt>(I->getOperand(1)) &&
                   cast<ConstantInt>(I->getOperand(1))->isOne();
    if (!Negates && !isa<ZExtInst>(I) &&
        !(isa<TruncInst>(I) && I->getType()->isIntegerTy(1)))
      break;
    Next = I->getOperand(0);
    if (Negates)
      V = Next;
  }
  return V;
}

/// The outcome of \p Predicate in the instrumented program.
static Value *outcomeOf(const Instruction &Predicate,
                        const AnalysedModule &Analysed) {
  Value *Outcome = Analysed.original(withoutNegation(conditionOf(Predicate)));
  return Outcome ? Outcome
                 : conditionOf(*cast<Instruction>(Analysed.original(
                       const_cast<Instruction *>(&Predicate))));
}

/// Follows \p V through bitwise operations, conversions and comparisons with
/// constants as long as it has a single use: the function continues with the
/// last value. Returns the counterpart of the last value that has one in the
/// instrumented program; null if not even \p V has one.
static Instruction *findJoined(Value *V, const AnalysedModule &Analysed) {
  SmallVector<Value *, 4> Chain{V};
  while (V->hasOneUse()) {
    auto *I = dyn_cast<Instruction>(*V->user_begin());
    if (!I || !(I->isBitwiseLogicOp() || isa<ZExtInst>(I) ||
                (isa<TruncInst>(I) && I->getType()->isIntegerTy(1)) ||
                (isa<ICmpInst>(I) && isa<Constant>(I->getOperand(1)))))
      break;
    Chain.push_back(V = I);
  }
  for (Value *Last : reverse(Chain))
    if (auto *There = dyn_cast_or_null<Instruction>(
            Analysed.original(withoutNegation(Last))))
      return There;
  return nullptr;
}

/// Plans the report of a flag, a switch or text, which has only one value.
static bool planFlag(const Comparison &C, bool IsUnsigned,
                     const AnalysedModule &Analysed, Report &R) {
  auto *Predicate = cast<Instruction>(Analysed.original(C.Predicate));
  bool IsText = !C.TextRelation.empty();
  Value *Flag = C.FlagValue == conditionOf(*C.Predicate)
                    ? conditionOf(*Predicate)
                    : Analysed.original(C.FlagValue);
  if (!Flag || Flag->getType()->isVectorTy() ||
      (!C.Direct && !C.IsOperand && !IsText))
    return false;
  R.Before = Predicate;
  R.Result = outcomeOf(*C.Predicate, Analysed);
  R.Switch = dyn_cast<SwitchInst>(Predicate);
  if (C.IsOperand || (IsText && !C.Direct)) {
    auto *Result = IsText ? findJoined(C.FlagValue, Analysed)
                          : dyn_cast<Instruction>(Flag);
    if (!Result)
      return false;
    R.Result = Result;
    R.Before = insertionPointAfter(*Result);
    R.Switch = nullptr;
  }
  R.Outcome = IsText ? Flag : R.Result;
  // An integer used as a condition is compared with zero; its value says more
  // than the outcome.
  if (auto *NotZero = dyn_cast<CmpInst>(Flag); NotZero && !IsText)
    Flag = NotZero->getOperand(isa<Constant>(NotZero->getOperand(0)) ? 1 : 0);
  R.Compared = R.Threshold = Flag;
  R.Signed = !IsUnsigned && !IsText;
  return R.Before;
}

std::optional<Report> planReport(const Comparison &C, bool IsUnsigned,
                                 const AnalysedModule &Analysed) {
  Report R;
  R.Key = C.Key;
  auto *Predicate = cast_or_null<Instruction>(Analysed.original(C.Predicate));
  if (!Predicate)
    return std::nullopt;
  // A program's own log_one would call itself without end.
  StringRef In = Predicate->getFunction()->getName();
  if (In == LogName || In == LogOfName)
    return std::nullopt;
  if (!C.Compare)
    return planFlag(C, IsUnsigned, Analysed, R) ? std::optional(R)
                                                : std::nullopt;
  auto *There = cast_or_null<Instruction>(Analysed.original(C.Compare));
  if (!There || There->getType()->isVectorTy())
    return std::nullopt;
  // A call has its operands in the same order.
  R.Held = dyn_cast<CallBase>(There);
  if (R.Held) {
    R.HeldRow = Analysed.rowOf(*R.Held);
    if (!R.HeldRow)
      return std::nullopt;
  }
  R.Threshold = There->getOperand(C.Threshold);
  R.Compared = There->getOperand(1 - C.Threshold);
  R.Outcome = There;
  if (const auto *Compare = dyn_cast<CmpInst>(There))
    // Equality does not say how its operands are to be read; a zero-extended
    // operand was not negative.
    R.Signed = !Compare->isUnsigned() &&
               !(Compare->isEquality() &&
                 (IsUnsigned || any_of(Compare->operands(), [](const Use &U) {
                    return isa<ZExtInst>(U);
                  })));
  if (C.Direct) {
    R.Result = outcomeOf(*C.Predicate, Analysed);
    R.Switch = dyn_cast<SwitchInst>(Predicate);
    R.Before = Predicate;
    return R;
  }
  Instruction *Result = findJoined(C.Compare, Analysed);
  R.Result = Result;
  // The comparison has a counterpart, so the chain has one, and no invoke ends
  // it. Should that ever be wrong, only this comparison has no report.
  R.Before = Result ? insertionPointAfter(*Result) : nullptr;
  return R.Before ? std::optional(R) : std::nullopt;
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

/// The outcome of \p Switch: whether it takes one of its cases and not the
/// default.
static Value *takesCase(IRBuilder<> &B, SwitchInst &Switch) {
  Value *Taken = B.getFalse();
  for (auto Case : Switch.cases())
    Taken = B.CreateOr(
        Taken, B.CreateICmpEQ(Switch.getCondition(), Case.getCaseValue()));
  return Taken;
}

static FunctionCallee logFunction(Module &M, bool HasObject) {
  LLVMContext &Ctx = M.getContext();
  Type *Bool = Type::getInt1Ty(Ctx), *Double = Type::getDoubleTy(Ctx);
  Type *Pointer = PointerType::getUnqual(Ctx);
  SmallVector<Type *, 6> Types{Pointer, Bool, Double, Double, Bool};
  if (HasObject)
    Types.push_back(Pointer);
  auto *T = FunctionType::get(Type::getVoidTy(Ctx), Types, false);
  FunctionCallee Callee =
      M.getOrInsertFunction(HasObject ? LogOfName : LogName, T);
  if (auto *F = dyn_cast<Function>(Callee.getCallee());
      F && F->isDeclaration()) {
    F->addParamAttr(1, Attribute::ZExt);
    F->addParamAttr(4, Attribute::ZExt);
    F->setDoesNotThrow();
    // log_one reads nothing of the program except the key, so the program may
    // keep values in registers across a report.
    F->setMemoryEffects(MemoryEffects::inaccessibleOrArgMemOnly());
    F->addParamAttr(0, Attribute::ReadOnly);
    F->addParamAttr(0, noCapture(Ctx));
    if (HasObject) {
      // Only its address counts.
      F->addParamAttr(5, Attribute::ReadNone);
      F->addParamAttr(5, noCapture(Ctx));
      F->setLinkage(GlobalValue::ExternalWeakLinkage);
    }
  }
  return Callee;
}

/// The flag of the log library that says whether reports are wanted. A program
/// defines it weakly, and the library finds that definition, so one load tells
/// the program and it also works without the library. A shared library refers
/// to the flag of the log library, if that is loaded: no pointer may lead into
/// a library that can be unloaded.
static GlobalVariable *wantedFlag(Module &M) {
  if (GlobalVariable *Wanted = M.getNamedGlobal("tpc_reporting"))
    return Wanted;
  Type *Byte = Type::getInt8Ty(M.getContext());
  bool IsProgram = M.getPIELevel() != PIELevel::Default ||
                   M.getPICLevel() == PICLevel::NotPIC;
  return new GlobalVariable(M, Byte, /*isConstant=*/false,
                            IsProgram ? GlobalValue::WeakAnyLinkage
                                      : GlobalValue::ExternalWeakLinkage,
                            IsProgram ? ConstantInt::get(Byte, 1) : nullptr,
                            "tpc_reporting");
}

namespace {

/// The words of a module, which it shares with the log library: one for each
/// comparison, in a cache line of its own. runtime_log/SiteWords.h has the same
/// layout: how many evaluations with either outcome need no call, the object
/// that this holds for, and the key.
class SiteTable {
public:
  static constexpr unsigned Bytes = 64, ObjectAt = 8;

  SiteTable(Module &M, ArrayRef<Report> Reports) : M(M) {
    LLVMContext &Ctx = M.getContext();
    auto *Pointer = PointerType::getUnqual(Ctx);
    KeyAt = ObjectAt + M.getDataLayout().getPointerSize();
    auto *Left = ArrayType::get(Type::getInt32Ty(Ctx), 2);
    auto *Key = ArrayType::get(Type::getInt8Ty(Ctx), Bytes - KeyAt);
    auto *Words = StructType::get(Ctx, {Left, Pointer, Key}, /*isPacked=*/true);
    SmallVector<Constant *, 0> All;
    for (const Report &R : Reports) {
      auto [It, New] = Numbers.try_emplace(nameOf(R), All.size());
      if (!New)
        continue;
      std::string Text = R.Key.substr(0, Bytes - KeyAt - 1);
      Text.resize(Bytes - KeyAt);
      All.push_back(ConstantStruct::get(
          Words, {Constant::getNullValue(Left), Constant::getNullValue(Pointer),
                  ConstantDataArray::getString(Ctx, Text, /*AddNull=*/false)}));
    }
    auto *T = ArrayType::get(Words, All.size());
    Table = new GlobalVariable(M, T, /*isConstant=*/false,
                               GlobalValue::InternalLinkage,
                               ConstantArray::get(T, All), "tpc.sites");
    Table->setAlignment(Align(Bytes));
  }

  /// The address of the key of \p R.
  Constant *keyOf(const Report &R) const {
    LLVMContext &Ctx = M.getContext();
    return ConstantExpr::getInBoundsGetElementPtr(
        Type::getInt8Ty(Ctx), Table,
        ConstantInt::get(Type::getInt64Ty(Ctx),
                         Numbers.lookup(nameOf(R)) * Bytes + KeyAt));
  }
  unsigned keyAt() const { return KeyAt; }

  /// Tells the log library of the words while the module is loaded.
  void announce() {
    call("tpc_register_sites", "tpc.register", appendToGlobalCtors);
    call("tpc_forget_sites", "tpc.forget", appendToGlobalDtors);
  }
  void erase() { Table->eraseFromParent(); }

private:
  /// The words of a comparison that passes an object are not those of one
  /// without.
  static std::string nameOf(const Report &R) {
    return (R.Object ? "o" : "k") + R.Key;
  }

  void call(StringRef Callee, StringRef Name,
            void (*Append)(Module &, Function *, int, Constant *)) {
    LLVMContext &Ctx = M.getContext();
    auto *Void = Type::getVoidTy(Ctx);
    FunctionCallee To = M.getOrInsertFunction(
        Callee, Void, PointerType::getUnqual(Ctx), Type::getInt64Ty(Ctx));
    if (auto *F = dyn_cast<Function>(To.getCallee()); F && F->isDeclaration())
      F->setLinkage(GlobalValue::ExternalWeakLinkage);
    auto *F = Function::Create(FunctionType::get(Void, false),
                               GlobalValue::InternalLinkage, Name, M);
    auto *Is = BasicBlock::Create(Ctx, "", F);
    auto *Tell = BasicBlock::Create(Ctx, "", F);
    auto *Done = BasicBlock::Create(Ctx, "", F);
    IRBuilder<> B(Is);
    B.CreateCondBr(B.CreateIsNull(To.getCallee()), Done, Tell);
    B.SetInsertPoint(Tell);
    B.CreateCall(To, {Table, B.getInt64(Numbers.size())});
    B.CreateBr(Done);
    B.SetInsertPoint(Done);
    B.CreateRetVoid();
    // Before the program's own constructors, which may evaluate comparisons.
    constexpr int First = 101;
    Append(M, F, First, nullptr);
  }

  Module &M;
  GlobalVariable *Table;
  StringMap<unsigned> Numbers;
  unsigned KeyAt;
};

} // namespace

/// `if (tpc_reporting) log_one(...)` as a function that the optimiser inlines:
/// a program whose reports are off pays for one branch. If \p Log is
/// log_one_of, and is not there, \p Plain gets the report. While only some
/// evaluations are inspected, the others are counted in the words of \p Sites.
static Function *reportFunction(Module &M, FunctionCallee Log,
                                FunctionCallee Plain, const SiteTable &Sites) {
  LLVMContext &Ctx = M.getContext();
  bool HasObject = Log.getCallee() != Plain.getCallee();
  auto *F =
      Function::Create(Log.getFunctionType(), GlobalValue::InternalLinkage,
                       HasObject ? "tpc.report.of" : "tpc.report", M);
  F->addFnAttr(Attribute::AlwaysInline);
  F->setDoesNotThrow();
  GlobalVariable *Wanted = wantedFlag(M);
  auto *Find = BasicBlock::Create(Ctx, "", F);
  auto *Look = BasicBlock::Create(Ctx, "", F);
  auto *Report = BasicBlock::Create(Ctx, "", F);
  auto *Done = BasicBlock::Create(Ctx, "", F);
  IRBuilder<> B(Find);
  if (Wanted->hasExternalWeakLinkage())
    B.CreateCondBr(B.CreateIsNull(Wanted), Report, Look);
  else
    B.CreateBr(Look);
  B.SetInsertPoint(Look);
  // It may change at any time.
  LoadInst *Now = B.CreateAlignedLoad(B.getInt8Ty(), Wanted, Align(1));
  Now->setAtomic(AtomicOrdering::Monotonic);
  auto *Some = BasicBlock::Create(Ctx, "", F, Report);
  auto *Count = BasicBlock::Create(Ctx, "", F, Report);
  auto *Pass = BasicBlock::Create(Ctx, "", F, Report);
  B.CreateCondBr(B.CreateIsNull(Now), Done, Some);
  B.SetInsertPoint(Some);
  constexpr char ReportFew = 2;
  Value *IsFew = B.CreateICmpEQ(Now, B.getInt8(ReportFew));
  auto At = [&](int64_t Offset) {
    return B.CreatePtrAdd(F->getArg(0), B.getInt64(Offset));
  };
  auto Load = [&](Type *T, Value *From) {
    LoadInst *L = B.CreateLoad(T, From);
    L->setAtomic(AtomicOrdering::Monotonic);
    return L;
  };
  const int64_t Begin = -static_cast<int64_t>(Sites.keyAt());
  if (HasObject) {
    auto *Own = BasicBlock::Create(Ctx, "", F, Count);
    B.CreateCondBr(IsFew, Own, Report);
    B.SetInsertPoint(Own);
    Value *Of = Load(B.getPtrTy(), At(Begin + SiteTable::ObjectAt));
    B.CreateCondBr(B.CreateICmpEQ(Of, F->getArg(5)), Count, Report);
  } else {
    B.CreateCondBr(IsFew, Count, Report);
  }
  B.SetInsertPoint(Count);
  Value *Left = B.CreateSelect(F->getArg(1), At(Begin + 4), At(Begin));
  Value *Number = Load(B.getInt32Ty(), Left);
  B.CreateCondBr(B.CreateIsNull(Number), Report, Pass);
  B.SetInsertPoint(Pass);
  Value *IsCounted = B.CreateICmpSGT(Number, B.getInt32(0));
  StoreInst *Store = B.CreateStore(
      B.CreateSub(Number, B.CreateZExt(IsCounted, B.getInt32Ty())), Left);
  Store->setAtomic(AtomicOrdering::Monotonic);
  B.CreateBr(Done);
  SmallVector<Value *, 6> Arguments;
  for (Argument &A : F->args())
    Arguments.push_back(&A);
  auto CallAt = [&](BasicBlock *At, FunctionCallee To) {
    B.SetInsertPoint(At);
    CallInst *Call = B.CreateCall(
        To,
        ArrayRef(Arguments).take_front(To.getFunctionType()->getNumParams()));
    Call->addParamAttr(1, Attribute::ZExt);
    Call->addParamAttr(4, Attribute::ZExt);
    B.CreateBr(Done);
  };
  if (!HasObject) {
    CallAt(Report, Log);
  } else {
    auto *Of = BasicBlock::Create(Ctx, "", F, Done);
    auto *One = BasicBlock::Create(Ctx, "", F, Done);
    B.SetInsertPoint(Report);
    B.CreateCondBr(B.CreateIsNull(Log.getCallee()), One, Of);
    CallAt(Of, Log);
    CallAt(One, Plain);
  }
  B.SetInsertPoint(Done);
  B.CreateRetVoid();
  return F;
}

std::string insertReports(Module &M, ArrayRef<Report> Reports) {
  if (Reports.empty())
    return "";
  const StringLiteral Added[] = {LogName, LogOfName};
  const bool WasThere[] = {M.getFunction(LogName) != nullptr,
                           M.getFunction(LogOfName) != nullptr};
  bool WasWanted = M.getNamedGlobal("tpc_reporting");
  FunctionCallee Log = logFunction(M, /*HasObject=*/false);
  SiteTable Sites(M, Reports);
  Function *ReportTo = reportFunction(M, Log, Log, Sites), *ReportOf = nullptr;
  if (any_of(Reports, [](const Report &R) { return R.Object; }))
    ReportOf =
        reportFunction(M, logFunction(M, /*HasObject=*/true), Log, Sites);
  SmallVector<Instruction *, 0> Inserted;
  Instruction *Above = nullptr, *Before = nullptr;
  auto Collect = [&] {
    for (Instruction *I = Before ? Before->getPrevNode() : nullptr; I != Above;
         I = I->getPrevNode())
      Inserted.push_back(I);
    Above = Before = nullptr;
  };
  auto Insert = [&](const Report &R) {
    assert(R.Before && R.Result && R.Compared && R.Threshold &&
           "a report without a place or a value");
    Value *Compared = R.Compared, *Threshold = R.Threshold;
    if (R.Held) {
      // Behind the call, the objects may be gone.
      Above = R.Held->getPrevNode();
      Before = R.Held;
      IRBuilder<> B(R.Held);
      Compared = heldSeconds(B, Compared, *R.Held, *R.HeldRow);
      Threshold = heldSeconds(B, Threshold, *R.Held, *R.HeldRow);
      Collect();
    }
    Above = R.Before->getPrevNode();
    Before = R.Before;
    IRBuilder<> B(R.Before);
    B.SetCurrentDebugLocation(R.Before->getDebugLoc());
    Value *Result = R.Switch ? takesCase(B, *R.Switch) : toBool(B, R.Result);
    Value *Outcome = R.Outcome == R.Result ? Result : toBool(B, R.Outcome);
    SmallVector<Value *, 6> Arguments{
        Sites.keyOf(R), Result, toDouble(B, Compared, R.Signed),
        toDouble(B, Threshold, R.Signed), Outcome};
    if (R.Object)
      Arguments.push_back(R.Object);
    B.CreateCall(R.Object ? ReportOf : ReportTo, Arguments);
    Collect();
  };
  std::string Why;
  raw_string_ostream OS(Why);
  if (runGuarded([&] { for_each(Reports, Insert); })) {
    if (!verifyModule(M, &OS)) {
      Sites.announce();
      NumReports += Reports.size();
      return "";
    }
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
  ReportTo->eraseFromParent();
  if (ReportOf)
    ReportOf->eraseFromParent();
  Sites.erase();
  if (GlobalVariable *Wanted = M.getNamedGlobal("tpc_reporting");
      Wanted && !WasWanted)
    Wanted->eraseFromParent();
  for (auto [Name, Was] : zip_equal(Added, WasThere))
    if (Function *F = M.getFunction(Name); F && !Was)
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
       << C.typeName() << " at " << C.Where->getLine() << ':'
       << C.Where->getColumn() << '\n';
  return PreservedAnalyses::all();
}

} // namespace tpc
