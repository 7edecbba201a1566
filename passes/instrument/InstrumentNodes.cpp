//===- InstrumentNodes.cpp ------------------------------------------------===//
#include "instrument/InstrumentNodes.h"

#include "Rules.h"
#include "instrument/Instances.h"
#include "instrument/InstrumentBranches.h"

#include "llvm/IR/DebugInfoMetadata.h"
#include "llvm/IR/IRBuilder.h"
#include "llvm/IR/InstIterator.h"

using namespace llvm;

namespace tpc {

/// `void log_node(const char *node, const void *object, unsigned long size)`
static constexpr StringLiteral LogName = "_Z8log_nodePKcPKvm";

/// `2ns4Node` for `ns::Node`; empty if it is in no namespace.
static std::string scopesOf(StringRef Class) {
  SmallVector<StringRef, 4> Scopes;
  Class.split(Scopes, "::");
  std::string Name;
  for (StringRef Scope : Scopes)
    Name += std::to_string(Scope.size()) + Scope.str();
  return Scopes.size() < 2 ? "" : Name;
}

std::string nodeNameOf(StringRef Class) {
  const std::string Scopes = scopesOf(Class);
  return Scopes.empty() ? "" : "_ZNK" + Scopes + "24get_fully_qualified_nameEv";
}

/// The type of a method that returns a C string.
static FunctionType *textMethod(LLVMContext &Ctx) {
  Type *Pointer = PointerType::getUnqual(Ctx);
  return FunctionType::get(Pointer, {Pointer}, false);
}

bool givesText(const Module &M, StringRef NodeName) {
  const Function *F = M.getFunction(NodeName);
  return !F || F->getFunctionType() == textMethod(M.getContext());
}

/// A function that the program need not have: its declaration is weak, unless
/// the program uses it.
static FunctionCallee weakFunction(Module &M, StringRef Name, FunctionType *T) {
  FunctionCallee Callee = M.getOrInsertFunction(Name, T);
  if (auto *F = dyn_cast<Function>(Callee.getCallee());
      F && F->isDeclaration() && F->use_empty())
    F->setLinkage(GlobalValue::ExternalWeakLinkage);
  return Callee;
}

Function *withNodeName(Module &M, StringRef Name, FunctionType *T,
                       unsigned Node, StringRef NodeName, StringRef LogName) {
  if (Function *Known = M.getFunction(Name))
    return Known;
  FunctionCallee Log = weakFunction(M, LogName, T);
  if (auto *F = dyn_cast<Function>(Log.getCallee()); F && F->isDeclaration()) {
    F->setDoesNotThrow();
    // As C++ passes a bool.
    for (Argument &A : F->args())
      if (A.getType()->isIntegerTy(1))
        A.addAttr(Attribute::ZExt);
  }
  LLVMContext &Ctx = M.getContext();
  FunctionCallee NameOf = weakFunction(M, NodeName, textMethod(Ctx));
  auto *F = Function::Create(T, GlobalValue::InternalLinkage, Name, M);
  auto *Look = BasicBlock::Create(Ctx, "", F);
  auto *Report = BasicBlock::Create(Ctx, "", F);
  auto *Done = BasicBlock::Create(Ctx, "", F);
  IRBuilder<> B(Look);
  B.CreateCondBr(B.CreateOr(B.CreateIsNull(Log.getCallee()),
                            B.CreateIsNull(NameOf.getCallee())),
                 Done, Report);
  B.SetInsertPoint(Report);
  SmallVector<Value *, 6> Arguments;
  for (Argument &A : F->args())
    Arguments.push_back(&A);
  Arguments[Node] = B.CreateCall(NameOf, {Arguments[Node]});
  CallInst *Call = B.CreateCall(Log, Arguments);
  for (Argument &A : F->args())
    if (A.getType()->isIntegerTy(1))
      Call->addParamAttr(A.getArgNo(), Attribute::ZExt);
  B.CreateBr(Done);
  B.SetInsertPoint(Done);
  B.CreateRetVoid();
  return F;
}

namespace {
/// A node that a call makes, or an interface of it that a call returns.
struct MadeNode {
  CallBase *By;
  Value *Node;
  Value *Object; ///< where it is, before By; for an interface, where By puts it
  uint64_t Size; ///< in bytes; 0 for an interface
  std::string NodeName; ///< of the method that returns its name
};
} // namespace

/// The argument that \p V is, in code that keeps arguments in variables, too;
/// null if it is none.
static const Argument *argumentOf(const Value *V) {
  if (const auto *A = dyn_cast<Argument>(V))
    return A;
  const auto *Load = dyn_cast<LoadInst>(V);
  const auto *Variable =
      Load ? dyn_cast<AllocaInst>(Load->getPointerOperand()) : nullptr;
  if (!Variable)
    return nullptr;
  const Argument *Found = nullptr;
  for (const User *U : Variable->users()) {
    const auto *Store = dyn_cast<StoreInst>(U);
    if (!Store || Store->getPointerOperand() != Variable)
      continue;
    const auto *A = dyn_cast<Argument>(Store->getValueOperand());
    if (!A || Found)
      return nullptr;
    Found = A;
  }
  return Found;
}

/// Completes \p Made, a node that its constructor makes: if it is the base
/// class of an object under construction, it is that object.
static void widen(MadeNode &Made) {
  Function &In = *Made.By->getFunction();
  Argument *Whole = objectOf(In);
  const DICompositeType *Class = classOf(In);
  if (!Whole || !Class || In.getSubprogram()->getName() != Class->getName() ||
      argumentOf(Made.Node->stripInBoundsConstantOffsets()) != Whole)
    return;
  Made.Object = Whole;
  Made.Size = std::max<uint64_t>(Class->getSizeInBits() / CHAR_BIT, 1);
}

static SmallVector<MadeNode, 0> findNodes(Module &M, StringRef Class) {
  SmallVector<MadeNode, 0> Found;
  const std::string Scopes = scopesOf(Class);
  const std::string Constructor = "_ZN" + Scopes + "C";
  const std::string Interface =
      "_ZN" + Scopes + "29get_node_parameters_interfaceEv";
  for (Function &F : M) {
    const bool IsInterface = F.getName() == Interface;
    StringRef Rest = F.getName();
    if (!IsInterface && !(Rest.consume_front(Constructor) &&
                          (Rest.starts_with("1E") || Rest.starts_with("2E"))))
      continue;
    for (User *U : F.users()) {
      auto *By = dyn_cast<CallBase>(U);
      if (!By || By->getCalledFunction() != &F ||
          By->arg_size() < (IsInterface ? 2U : 1U) ||
          (IsInterface && !By->paramHasAttr(0, Attribute::StructRet)))
        continue;
      Value *First = By->getArgOperand(0);
      MadeNode Made{By, IsInterface ? By->getArgOperand(1) : First, First,
                    IsInterface ? 0U : 1U, nodeNameOf(Class)};
      if (!IsInterface)
        widen(Made);
      Found.push_back(std::move(Made));
    }
  }
  return Found;
}

/// `void tpc.node.NODE(node, object, size)`, which calls log_node.
static Function *reportFunction(Module &M, StringRef NodeName) {
  LLVMContext &Ctx = M.getContext();
  Type *Pointer = PointerType::getUnqual(Ctx);
  auto *T = FunctionType::get(
      Type::getVoidTy(Ctx),
      {Pointer, Pointer, M.getDataLayout().getIntPtrType(Ctx)}, false);
  return withNodeName(M, ("tpc.node." + NodeName).str(), T, 0, NodeName,
                      LogName);
}

SmallVector<Instruction *, 0> insertNodes(Module &M, const Rules &Tables) {
  SmallVector<Instruction *, 0> Inserted;
  for (const std::string &Class : Tables.nodeClasses())
    for (const MadeNode &Made : findNodes(M, Class)) {
      Instruction *Before = insertionPointAfter(*Made.By);
      if (!Before || Made.NodeName.empty() || !givesText(M, Made.NodeName))
        continue;
      IRBuilder<> B(Before);
      B.SetCurrentDebugLocation(Made.By->getDebugLoc());
      Value *Object = Made.Object;
      if (!Made.Size) {
        // A std::shared_ptr begins with the pointer.
        auto *Load = B.CreateLoad(B.getPtrTy(), Object);
        Inserted.push_back(Load);
        Object = Load;
      }
      Type *Number = M.getDataLayout().getIntPtrType(M.getContext());
      Inserted.push_back(B.CreateCall(
          reportFunction(M, Made.NodeName),
          {Made.Node, Object,
           ConstantInt::get(Number, std::max<uint64_t>(Made.Size, 1))}));
    }
  return Inserted;
}

} // namespace tpc
