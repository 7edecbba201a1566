//===- Received.cpp -------------------------------------------------------===//
#include "memory/Received.h"

#include "calls/SimpleCallGraph.h"
#include "support/Functions.h"
#include "support/Names.h"

#include "llvm/ADT/SmallPtrSet.h"
#include "llvm/BinaryFormat/Dwarf.h"
#include "llvm/IR/IntrinsicInst.h"
#include "llvm/IR/Operator.h"

using namespace llvm;

namespace tpc {

/// True if \p T is a message that must not be changed, or a smart pointer to
/// one.
static bool isConstMessage(const DIType *T) {
  bool IsConst = false;
  while (const auto *Derived = dyn_cast_or_null<DIDerivedType>(T)) {
    IsConst |= Derived->getTag() == dwarf::DW_TAG_const_type;
    T = Derived->getBaseType();
  }
  const auto *Class = dyn_cast_or_null<DICompositeType>(T);
  if (!Class)
    return false;
  if (isMessageClass(*Class))
    return IsConst;
  if (!isSmartPointer(Class) && !Class->getName().starts_with("MessageEvent<"))
    return false;
  for (const DITemplateParameter *P : Class->getTemplateParams())
    return P && isConstMessage(P->getType());
  return false;
}

Received::Received(Module &M, const CallGraphResult &Calls, DebugTypes &Debug,
                   const LocationTypes &Types, PointsTo &Pointers,
                   const AccessIndex &Accesses, UserSources Own)
    : Calls(Calls), Debug(Debug), Types(Types), Pointers(Pointers),
      Accesses(Accesses), Sources(std::move(Own)) {
  for (const Function &F : definedFunctions(M))
    if (Sources.has(F))
      for (const Argument &Arg : F.args())
        if (isHandedOver(Arg))
          Found.insert(&Arg);
  for (size_t N = 0; N < Found.size(); ++N)
    addUsersOf(Found[N]);
  while (Found.remove_if([&](const Value *V) { return !isSupported(V); }))
    ;
}

/// True if \p Arg is a message that a library hands to the program, which does
/// not change it.
bool Received::isHandedOver(const Argument &Arg) {
  const Function &F = *Arg.getParent();
  bool ByLibrary = !Calls.mentions(&F).empty() ||
                   any_of(Calls.callers(&F), [&](const CallBase *Call) {
                     return !Sources.has(*Call->getFunction());
                   });
  if (!ByLibrary || !Arg.getType()->isPointerTy() || Arg.hasStructRetAttr())
    return false;
  if (isConstMessage(DebugTypes::declared(Arg)))
    return true;
  const auto *Class = dyn_cast_or_null<DICompositeType>(Debug.pointee(&Arg));
  return Class && isMessageClass(*Class) && isOnlyRead(Arg);
}

/// True if nothing is written through \p Arg or a pointer that it leads to, and
/// no such pointer is stored.
bool Received::isOnlyRead(const Argument &Arg) {
  constexpr unsigned MostPointers = 256;
  SmallSetVector<const Value *, 16> Work;
  Work.insert(&Arg);
  for (unsigned N = 0; N < Work.size(); ++N)
    for (const Use &U : Work[N]->uses()) {
      const auto *I = cast<Instruction>(U.getUser());
      const auto *Call = dyn_cast<CallBase>(I);
      const auto *Fill = dyn_cast<MemIntrinsic>(I);
      if (Work.size() > MostPointers || isa<StoreInst>(I) ||
          (Fill && U.getOperandNo() == 0))
        return false;
      if (Call && !isa<IntrinsicInst>(Call)) {
        SmallVector<Function *, 1> Callees = Calls.callees(*Call);
        if (Callees.empty() ? !Accesses.isUnchanged(U) && !endsLife(*Call)
                            : !Call->isArgOperand(&U))
          return false;
        for (const Function *Callee : Callees)
          if (Call->getArgOperandNo(&U) < Callee->arg_size())
            Work.insert(Callee->getArg(Call->getArgOperandNo(&U)));
      }
      if (I->getType()->isPointerTy())
        Work.insert(I);
    }
  return true;
}

/// True for the classes in which std::bind, boost::bind and std::thread keep
/// what the program passes.
static bool keepsBound(const DICompositeType &Class) {
  std::string Name = DebugTypes::identifierOf(Class);
  return any_of(
      ArrayRef<StringRef>{"_ZTSN5boost3_bi6bind_tI", "_ZTSSt5_BindI",
                          "_ZTSNSt6thread"},
      [&](StringRef Begin) { return StringRef(Name).starts_with(Begin); });
}

/// True if the program made what is at \p L: a local, a member of one of its
/// classes, an element of a container, or what it bound to the callback.
bool Received::isOwn(const Location &L) {
  if (isa_and_nonnull<GlobalVariable>(L.Root) || L.isElement())
    return true;
  const auto *Root = dyn_cast_or_null<Instruction>(L.Root);
  return (Root && Sources.has(*Root->getFunction())) ||
         any_of(L.Path, [&](const Step &S) {
           const DICompositeType *Class =
               S.isField() ? Types.sourceClassOf(S) : nullptr;
           return Class &&
                  ((Class->getFile() && Sources.has(Class->getFile())) ||
                   keepsBound(*Class));
         });
}

/// True if \p Call, in a library, passes a message for argument \p N that is
/// not seen to be the program's: algorithms and factories pass on what the
/// program gave them.
bool Received::handsOver(const CallBase &Call, unsigned N) {
  return N < Call.arg_size() && !Sources.has(*Call.getFunction()) &&
         none_of(
             Pointers.resolve(Call.getArgOperand(N), false),
             [&](const Location &L) { return isOwn(L); });
}

/// Adds the pointers that \p Pointer can be, or be a part of.
void Received::addUsersOf(const Value *Pointer) {
  SmallVector<const Value *, 8> Work{Pointer};
  SmallPtrSet<const Value *, 8> Seen;
  while (!Work.empty()) {
    const Value *V = Work.pop_back_val();
    if (!Seen.insert(V).second)
      continue;
    for (const Use &U : V->uses()) {
      const auto *User = cast<Instruction>(U.getUser());
      if (isa<GetElementPtrInst, CastInst, FreezeInst>(User)) {
        Work.push_back(User);
      } else if (isa<PHINode, SelectInst, LoadInst>(User)) {
        if (User->getType()->isPointerTy())
          Found.insert(User);
      } else if (const auto *Call = dyn_cast<CallBase>(User);
                 Call && Call->isArgOperand(&U)) {
        unsigned N = Call->getArgOperandNo(&U);
        for (const Function *Callee : Calls.callees(*Call))
          if (N < Callee->arg_size())
            Found.insert(Callee->getArg(N));
      }
    }
  }
}

bool Received::isSupported(const Value *Pointer) {
  if (const auto *Load = dyn_cast<LoadInst>(Pointer))
    return has(Load->getPointerOperand());
  if (const auto *Phi = dyn_cast<PHINode>(Pointer))
    return all_of(Phi->incoming_values(),
                  [&](const Value *V) { return has(V); });
  if (const auto *Select = dyn_cast<SelectInst>(Pointer))
    return has(Select->getTrueValue()) && has(Select->getFalseValue());
  const auto &Arg = *cast<Argument>(Pointer);
  const Function &F = *Arg.getParent();
  bool FromLibrary = isHandedOver(Arg);
  return (FromLibrary || Calls.allCallsKnown(F)) &&
         all_of(Calls.callers(&F), [&](const CallBase *Call) {
           return (FromLibrary && handsOver(*Call, Arg.getArgNo())) ||
                  (Arg.getArgNo() < Call->arg_size() &&
                   has(Call->getArgOperand(Arg.getArgNo())));
         });
}

bool Received::has(const Value *Pointer) const {
  if (Found.empty() || !Pointer)
    return false;
  const Value *Origin = PointsTo::baseOf(Pointer);
  return isa<ConstantPointerNull, UndefValue>(Origin) || Found.contains(Origin);
}

} // namespace tpc
