//===- Received.cpp -------------------------------------------------------===//
#include "memory/Received.h"

#include "calls/SimpleCallGraph.h"
#include "support/Functions.h"
#include "support/Names.h"

#include "llvm/ADT/SmallPtrSet.h"
#include "llvm/IR/IntrinsicInst.h"
#include "llvm/IR/Operator.h"

using namespace llvm;

namespace tpc {

/// The pointer that \p Pointer is computed from without reading memory.
static const Value *originOf(const Value *Pointer) {
  while (true) {
    if (const auto *GEP = dyn_cast<GEPOperator>(Pointer))
      Pointer = GEP->getPointerOperand();
    else if (const auto *Cast = dyn_cast<CastInst>(Pointer);
             Cast && Cast->getOperand(0)->getType()->isPointerTy())
      Pointer = Cast->getOperand(0);
    else if (const auto *Freeze = dyn_cast<FreezeInst>(Pointer))
      Pointer = Freeze->getOperand(0);
    else
      return Pointer;
  }
}

/// True for a message, or an object that leads to one and nothing else.
static bool isMessage(const DIType *T) {
  const auto *Class = dyn_cast_or_null<DICompositeType>(T);
  if (!Class)
    return false;
  if (isMessageClass(*Class))
    return true;
  StringRef Name = Class->getName().split('<').first;
  if (Name != "shared_ptr" && Name != "unique_ptr" && Name != "MessageEvent")
    return false;
  for (const DITemplateParameter *P : Class->getTemplateParams()) {
    const auto *Inner = dyn_cast_or_null<DICompositeType>(
        DebugTypes::plain(P ? P->getType() : nullptr));
    return Inner && isMessageClass(*Inner);
  }
  return false;
}

Received::Received(Module &M, const CallGraphResult &Calls, DebugTypes &Debug,
                   const LocationTypes &Types, PointsTo &Pointers,
                   UserSources Own)
    : Calls(Calls), Debug(Debug), Types(Types), Pointers(Pointers),
      Sources(std::move(Own)) {
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

/// True if \p Arg is a message that a library hands to the program.
bool Received::isHandedOver(const Argument &Arg) {
  const Function &F = *Arg.getParent();
  bool ByLibrary =
      !Calls.mentions(&F).empty() ||
      any_of(Calls.callers(&F), [&](const CallBase *Call) {
        return !Sources.has(*Call->getFunction());
      });
  return ByLibrary && Arg.getType()->isPointerTy() &&
         !Arg.hasStructRetAttr() && isMessage(Debug.pointee(&Arg));
}

/// True if the program made what is at \p L: a local, a member of one of its
/// classes, or an element of a container.
bool Received::isOwn(const Location &L) {
  if (isa_and_nonnull<GlobalVariable>(L.Root) || L.isElement())
    return true;
  const auto *Root = dyn_cast_or_null<Instruction>(L.Root);
  return (Root && Sources.has(*Root->getFunction())) ||
         any_of(L.Path, [&](const Step &S) {
           const DICompositeType *Class =
               S.isField() ? Types.sourceClassOf(S) : nullptr;
           return Class && Class->getFile() && Sources.has(Class->getFile());
         });
}

/// True if \p Call, in a library, passes a message for argument \p N that is
/// not seen to be the program's: algorithms and factories pass on what the
/// program gave them.
bool Received::handsOver(const CallBase &Call, unsigned N) {
  return N < Call.arg_size() && !Sources.has(*Call.getFunction()) &&
         none_of(Pointers.resolve(Call.getArgOperand(N), false),
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
  const Value *Origin = originOf(Pointer);
  return isa<ConstantPointerNull, UndefValue>(Origin) ||
         Found.contains(Origin);
}

bool Received::isWrittenBy(const Instruction &Write) const {
  if (const Value *Pointer = getLoadStorePointerOperand(&Write))
    return has(Pointer);
  if (const auto *Copy = dyn_cast<MemIntrinsic>(&Write))
    return has(Copy->getRawDest());
  const auto *Call = dyn_cast<CallBase>(&Write);
  return Call && any_of(Call->args(), [&](const Use &Arg) {
           return Arg->getType()->isPointerTy() && has(Arg);
         });
}

} // namespace tpc
