//===- InstrumentReads.cpp ------------------------------------------------===//
#include "instrument/InstrumentReads.h"

#include "instrument/Instances.h"
#include "instrument/InstrumentNodes.h"
#include "params/Texts.h"
#include "support/Names.h"

#include "llvm/BinaryFormat/Dwarf.h"
#include "llvm/IR/DebugInfoMetadata.h"
#include "llvm/IR/IRBuilder.h"
#include "llvm/IR/Module.h"

using namespace llvm;

namespace tpc {

/// `void log_read(char *key, const void *handle, const void *name, bool text)`
static constexpr StringLiteral LogName = "_Z8log_readPcPKvS1_b";

/// The same with `const void *object, unsigned long size` at the end.
static constexpr StringLiteral LogOfName = "_Z11log_read_ofPcPKvS1_bS1_m";

/// `void log_read_in(char *key, const char *node, const void *name, bool text,
/// const void *object, unsigned long size)`
static constexpr StringLiteral LogInName = "_Z11log_read_inPcPKcPKvbS3_m";

/// The offset in bytes of the field \p Name in the class that \p Method is a
/// method of; none if the debug information does not have it.
static std::optional<uint64_t> offsetOf(const Function &Method,
                                        StringRef Name) {
  const DISubprogram *SP = Method.getSubprogram();
  const auto *Class =
      dyn_cast_or_null<DICompositeType>(SP ? SP->getScope() : nullptr);
  if (!Class)
    return std::nullopt;
  for (const DINode *Element : Class->getElements()) {
    const auto *Field = dyn_cast_or_null<DIDerivedType>(Element);
    if (Field && Field->getTag() == dwarf::DW_TAG_member &&
        !Field->isStaticMember() && Field->getName() == Name)
      return Field->getOffsetInBits() / CHAR_BIT;
  }
  return std::nullopt;
}

/// Whether argument \p Number of the function \p Mangled is a C string; none if
/// it is neither that nor a std::string as the log library has it.
static std::optional<bool> isText(StringRef Mangled, unsigned Number) {
  const SmallVector<std::string, 4> Types = parameterTypes(Mangled);
  StringRef Type = Number < Types.size() ? Types[Number] : StringRef();
  if (Type == "char const*")
    return true;
  if (Type.starts_with("std::__cxx11::basic_string<char,") &&
      !Type.ends_with("*"))
    return false;
  return std::nullopt;
}

std::optional<NamedRead> planName(const ParameterRead &Read,
                                  const AnalysedModule &Analysed) {
  const Rule &Row = *Read.Row;
  if (Row.Resolve.empty() || Read.Key.empty())
    return std::nullopt;
  auto *Call = dyn_cast_or_null<CallBase>(Analysed.original(Read.Call));
  if (!Call)
    return std::nullopt;
  NamedRead R{
      Read.Key,   Call, objectOf(*Call, Row), 0, argument(*Call, Row, Row.Name),
      Read.Field, false};
  if (Argument *Object = objectOf(*Call->getFunction())) {
    R.Object = Object;
    R.ObjectSize = classOf(*Call->getFunction())->getSizeInBits() / CHAR_BIT;
  }
  if (Row.Kind == Rule::Config) {
    const Function *Callee = Call->getCalledFunction();
    std::optional<uint64_t> Offset =
        Callee ? offsetOf(*Callee, Row.Resolve) : std::nullopt;
    if (!R.Handle || !Offset || R.Text.empty())
      return std::nullopt;
    R.HandleOffset = *Offset;
    return R;
  }
  if (Row.Resolve == "node") {
    R.NodeName = nodeNameOf(StringRef(Row.Function).rsplit("::").first);
    if (!givesText(*Call->getModule(), R.NodeName))
      return std::nullopt;
  }
  if (Row.Resolve == "global")
    R.Handle = nullptr;
  else if (!R.Handle)
    return std::nullopt;
  if (Row.Many != Rule::One) {
    R.Name = nullptr;
    R.Text = Read.Name;
    return isDynamic(Read.Name) ? std::nullopt : std::optional(R);
  }
  const Function *Callee = Call->getCalledFunction();
  const StringRef Mangled =
      Callee ? nameOfOriginal(*Callee) : StringRef(Row.Symbol);
  std::optional<bool> IsText =
      R.Name ? isText(Mangled, *Row.Name) : std::nullopt;
  if (!IsText || !R.Name->getType()->isPointerTy())
    return std::nullopt;
  R.IsText = *IsText;
  return R;
}

/// Weak, so that a program also runs without the log library.
static FunctionCallee logFunction(Module &M, bool HasObject) {
  LLVMContext &Ctx = M.getContext();
  Type *Pointer = PointerType::getUnqual(Ctx);
  SmallVector<Type *, 6> Types{Pointer, Pointer, Pointer, Type::getInt1Ty(Ctx)};
  if (HasObject)
    Types.append({Pointer, M.getDataLayout().getIntPtrType(Ctx)});
  auto *T = FunctionType::get(Type::getVoidTy(Ctx), Types, false);
  FunctionCallee Callee =
      M.getOrInsertFunction(HasObject ? LogOfName : LogName, T);
  if (auto *F = dyn_cast<Function>(Callee.getCallee());
      F && F->isDeclaration()) {
    F->setLinkage(GlobalValue::ExternalWeakLinkage);
    F->addParamAttr(3, Attribute::ZExt);
    F->setDoesNotThrow();
  }
  return Callee;
}

/// `if (log_read) log_read(...)`; with \p Else, `if (log_read_of)
/// log_read_of(...) else ...`.
static Function *reportFunction(Module &M, FunctionCallee Log,
                                Function *Else = nullptr) {
  LLVMContext &Ctx = M.getContext();
  auto *F =
      Function::Create(Log.getFunctionType(), GlobalValue::InternalLinkage,
                       Else ? "tpc.read.of" : "tpc.read", M);
  F->setDoesNotThrow();
  auto *Look = BasicBlock::Create(Ctx, "", F);
  auto *Report = BasicBlock::Create(Ctx, "", F);
  auto *Done = BasicBlock::Create(Ctx, "", F);
  IRBuilder<> B(Look);
  BasicBlock *Without = Else ? BasicBlock::Create(Ctx, "", F, Done) : Done;
  B.CreateCondBr(B.CreateIsNull(Log.getCallee()), Without, Report);
  B.SetInsertPoint(Report);
  SmallVector<Value *, 6> Arguments;
  for (Argument &A : F->args())
    Arguments.push_back(&A);
  B.CreateCall(Log, Arguments)->addParamAttr(3, Attribute::ZExt);
  B.CreateBr(Done);
  if (Else) {
    B.SetInsertPoint(Without);
    B.CreateCall(Else, ArrayRef(Arguments).take_front(Else->arg_size()));
    B.CreateBr(Done);
  }
  B.SetInsertPoint(Done);
  B.CreateRetVoid();
  return F;
}

/// `void tpc.read.in.NODE(key, node, name, text, object, size)`, which calls
/// log_read_in.
static Function *nodeReportFunction(Module &M, StringRef NodeName) {
  LLVMContext &Ctx = M.getContext();
  Type *Pointer = PointerType::getUnqual(Ctx);
  auto *T = FunctionType::get(Type::getVoidTy(Ctx),
                              {Pointer, Pointer, Pointer, Type::getInt1Ty(Ctx),
                               Pointer, M.getDataLayout().getIntPtrType(Ctx)},
                              false);
  return withNodeName(M, ("tpc.read.in." + NodeName).str(), T, 1, NodeName,
                      LogInName);
}

static Constant *textOf(Module &M, StringRef Text, const Twine &Name) {
  Constant *Data = ConstantDataArray::getString(M.getContext(), Text);
  auto *G = new GlobalVariable(M, Data->getType(), /*isConstant=*/true,
                               GlobalValue::PrivateLinkage, Data, Name);
  G->setUnnamedAddr(GlobalValue::UnnamedAddr::Global);
  return G;
}

SmallVector<Instruction *, 0> insertNames(Module &M,
                                          ArrayRef<NamedRead> Reads) {
  SmallVector<Instruction *, 0> Inserted;
  if (Reads.empty())
    return Inserted;
  Function *Report = nullptr, *ReportOf = nullptr;
  auto IsResolved = [](const NamedRead &R) { return R.NodeName.empty(); };
  if (any_of(Reads, IsResolved))
    Report = reportFunction(M, logFunction(M, /*HasObject=*/false));
  if (any_of(Reads,
             [&](const NamedRead &R) { return R.Object && IsResolved(R); }))
    ReportOf = reportFunction(M, logFunction(M, /*HasObject=*/true), Report);
  for (const NamedRead &R : Reads) {
    IRBuilder<> B(R.Before);
    B.SetCurrentDebugLocation(R.Before->getDebugLoc());
    Value *Handle = Constant::getNullValue(B.getPtrTy());
    if (R.Handle) {
      Handle = B.CreateConstGEP1_64(B.getInt8Ty(), R.Handle, R.HandleOffset);
      if (auto *I = dyn_cast<Instruction>(Handle); I && I != R.Handle)
        Inserted.push_back(I);
    }
    Value *Name = R.Name ? R.Name : textOf(M, R.Text, "tpc.name");
    SmallVector<Value *, 6> Arguments{textOf(M, R.Key, "tpc.key"), Handle, Name,
                                      B.getInt1(!R.Name || R.IsText)};
    Value *Object = R.Object;
    if (!Object && !IsResolved(R))
      Object = Constant::getNullValue(B.getPtrTy());
    if (Object)
      Arguments.append(
          {Object,
           ConstantInt::get(M.getDataLayout().getIntPtrType(M.getContext()),
                            R.ObjectSize)});
    Function *To = !IsResolved(R) ? nodeReportFunction(M, R.NodeName)
                   : R.Object     ? ReportOf
                                  : Report;
    Inserted.push_back(B.CreateCall(To, Arguments));
  }
  return Inserted;
}

} // namespace tpc
