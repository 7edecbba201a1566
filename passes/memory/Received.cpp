//===- Received.cpp -------------------------------------------------------===//
#include "memory/Received.h"

#include "calls/SimpleCallGraph.h"
#include "memory/PointerCopies.h"
#include "support/Functions.h"
#include "support/Names.h"

#include "llvm/ADT/SmallPtrSet.h"
#include "llvm/Analysis/ValueTracking.h"
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
  return (isSmartPointer(Class) ||
          Class->getName().starts_with("MessageEvent<")) &&
         isConstMessage(firstArgumentOf(*Class));
}

Received::Received(Module &M, const CallGraphResult &Calls, DebugTypes &Debug,
                   const LocationTypes &Types, PointsTo &Pointers,
                   AccessIndex &Accesses, UserSources Own)
    : Calls(Calls), Debug(Debug), Types(Types), Pointers(Pointers),
      Accesses(Accesses), Sources(std::move(Own)) {
  for (const Function &F : definedFunctions(M))
    if (Sources.has(F))
      for (const Argument &Arg : F.args())
        if (isHandedOver(Arg))
          Found.insert(&Arg);
  for (size_t N = 0; N < Found.size(); ++N)
    addUsersOf(Found[N]);
  Reached.insert(Found.begin(), Found.end());
  while (Found.remove_if([&](const Value *V) { return !isSupported(V); }))
    ;
}

/// True if \p Arg is a message that a library hands to the program, which does
/// not change it.
bool Received::isHandedOver(const Argument &Arg) {
  const Function &F = *Arg.getParent();
  bool ByLibrary = any_of(Calls.callers(&F), [&](const CallBase *Call) {
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

/// True for the classes in which std::bind, boost::bind and threads keep what
/// the program passes.
static bool keepsBound(StringRef Name) {
  return any_of(
      ArrayRef<StringRef>{"boost::_bi::", "boost::detail::thread_data",
                          "std::_Bind", "std::_Head_base", "std::_Tuple_impl",
                          "std::thread", "std::tuple"},
      [&](StringRef Begin) { return Name.starts_with(Begin); });
}

/// True if the program made what is at \p L: a local, a member of one of its
/// classes, an element of a container, or what it bound to a callback.
bool Received::isOwn(const Location &L) {
  bool InFunction = false;
  for (const Step &S : L.Path) {
    if (!S.isField())
      continue;
    const DICompositeType *Class = Types.sourceClassOf(S);
    StringRef Name = plainClassName(*Types.classOf(S));
    if (keepsBound(Name) ||
        (Class && Class->getFile() && Sources.has(Class->getFile())))
      return true;
    InFunction |= Name.ends_with("function_buffer") || Name == "std::_Any_data";
  }
  // A function object and its argument are not always told apart.
  if (InFunction)
    return false;
  const auto *Root = dyn_cast_or_null<Instruction>(L.Root);
  return isa_and_nonnull<GlobalVariable>(L.Root) || L.isElement() ||
         (Root && Sources.has(*Root->getFunction()));
}

/// True if \p Call, in a library, passes a message for argument \p N that is
/// not the program's: algorithms, factories and threads pass on what the
/// program gave them. A smart pointer is the program's if any is from which it
/// was copied.
bool Received::isPassedOn(const CallBase &Call, unsigned N) {
  if (Sources.has(*Call.getFunction()))
    return false;
  const Value *Arg = Call.getArgOperand(N);
  auto IsOwn = [&](const Location &L) { return isOwn(L); };
  if (any_of(Pointers.resolve(Arg, false), IsOwn))
    return false;
  if (!isSmartPointer(Debug.pointee(Arg)))
    return true;
  PointerCopies Copies(Pointers, Accesses);
  Locations Kept = Pointers.resolve(Arg, true);
  for (size_t Next = 0; Next < Kept.size(); ++Next) {
    const Location L = Kept[Next];
    if (IsOwn(L))
      return false;
    for (const StoreInst *Store : Copies.storesTo(L, getUnderlyingObject(Arg)))
      for (const Location &Source : Copies.sourcesOf(Store->getValueOperand()))
        addTo(Kept, Source);
  }
  return !Kept.empty();
}

/// isPassedOn(), found once for each call.
bool Received::handsOver(const CallBase &Call, unsigned N) {
  auto [It, IsNew] = PassedOn.try_emplace(&Call.getArgOperandUse(N));
  if (IsNew)
    It->second = isPassedOn(Call, N);
  return It->second;
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
           return Arg.getArgNo() < Call->arg_size() &&
                  (has(Call->getArgOperand(Arg.getArgNo())) ||
                   (FromLibrary && handsOver(*Call, Arg.getArgNo())));
         });
}

bool Received::has(const Value *Pointer) const {
  if (Found.empty() || !Pointer)
    return false;
  const Value *Origin = PointsTo::baseOf(Pointer);
  return isa<ConstantPointerNull, UndefValue>(Origin) || Found.contains(Origin);
}

bool Received::mayHave(const Value *Pointer) const {
  return Reached.contains(PointsTo::baseOf(Pointer));
}

} // namespace tpc
