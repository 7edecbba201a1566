//===- Callbacks.cpp ------------------------------------------------------===//
#include "params/Callbacks.h"

#include "support/DebugTypes.h"

#include "llvm/IR/IntrinsicInst.h"
#include "llvm/IR/Operator.h"

using namespace llvm;

namespace tpc {

namespace {

class CallbackSearch {
public:
  explicit CallbackSearch(UserSources &Sources) : Sources(Sources) {}

  SmallSetVector<Function *, 2> from(const Value *Callback);

private:
  void value(const Value *V);
  void object(const Value *Local);
  void library(const Function &F);
  void push(const Value *V) {
    if (Seen.insert(V).second)
      Work.push_back(V);
  }

  UserSources &Sources;
  SmallVector<const Value *, 16> Work;
  SmallPtrSet<const Value *, 32> Seen;
  SmallSetVector<Function *, 2> Found;
};

} // namespace

/// What wraps a function is shallow; beyond this it is something else.
static constexpr unsigned MaxSearched = 256;

void CallbackSearch::value(const Value *V) {
  if (const auto *F = dyn_cast<Function>(V)) {
    if (F->isDeclaration())
      return;
    if (Sources.has(*F))
      Found.insert(const_cast<Function *>(F));
    else
      library(*F);
  } else if (isa<AllocaInst>(V)) {
    object(V);
  } else if (isa<ConstantExpr, ConstantAggregate>(V)) {
    for (const Value *Part : cast<User>(V)->operands())
      push(Part);
  }
}

/// What is stored to the local object \p Local, and what constructs it: a call
/// that gets it first, with the objects that it is made of.
void CallbackSearch::object(const Value *Local) {
  SmallVector<const Value *, 4> Pointers{Local};
  while (!Pointers.empty())
    for (const User *U : Pointers.pop_back_val()->users()) {
      if (isa<GEPOperator>(U) && isa<Instruction>(U)) {
        Pointers.push_back(U);
      } else if (const auto *Store = dyn_cast<StoreInst>(U)) {
        push(Store->getValueOperand());
      } else if (const auto *Copy = dyn_cast<MemTransferInst>(U)) {
        push(Copy->getRawSource()->stripInBoundsOffsets());
      } else if (const auto *Call = dyn_cast<CallBase>(U);
                 Call && !isa<IntrinsicInst>(Call) && !Call->arg_empty() &&
                 Call->getArgOperand(0)->stripInBoundsOffsets() == Local) {
        if (const Function *Callee = Call->getCalledFunction();
            Callee && !Sources.has(*Callee))
          push(Callee);
        for (const Value *Arg : drop_begin(Call->args()))
          if (isa<AllocaInst, Function>(Arg->stripInBoundsOffsets()))
            push(Arg->stripInBoundsOffsets());
      }
    }
}

/// The functions that the library function \p F calls or mentions.
void CallbackSearch::library(const Function &F) {
  for (const Instruction &I : instructions(F))
    for (const Value *V : I.operands())
      if (isa<Function, ConstantExpr, ConstantAggregate>(V))
        push(V);
}

SmallSetVector<Function *, 2> CallbackSearch::from(const Value *Callback) {
  push(Callback->stripInBoundsOffsets());
  while (!Work.empty() && Seen.size() < MaxSearched)
    value(Work.pop_back_val());
  return std::move(Found);
}

/// The call operators of the lambdas that are template arguments of the
/// function that \p Call calls: it may get them by reference, as they are.
static SmallSetVector<Function *, 2> lambdasOf(const CallBase &Call,
                                               UserSources &Sources) {
  SmallSetVector<Function *, 2> Found;
  const Function *Callee = Call.getCalledFunction();
  const DISubprogram *SP = Callee ? Callee->getSubprogram() : nullptr;
  SmallPtrSet<const DIScope *, 4> Types;
  if (SP)
    for (const DITemplateParameter *P : SP->getTemplateParams())
      if (const auto *Class = dyn_cast_or_null<DICompositeType>(
              DebugTypes::plain(P ? P->getType() : nullptr)))
        Types.insert(Class);
  if (Types.empty())
    return Found;
  for (const Function &F : *Call.getModule())
    if (const DISubprogram *Own = F.getSubprogram();
        Own && Own->getName() == "operator()" &&
        Types.contains(Own->getScope()) && Sources.has(F))
      Found.insert(const_cast<Function *>(&F));
  return Found;
}

SmallSetVector<Function *, 2> calledBackBy(const Value &Callback,
                                           const CallBase &Call,
                                           UserSources &Sources) {
  SmallSetVector<Function *, 2> Found = CallbackSearch(Sources).from(&Callback);
  return Found.empty() ? lambdasOf(Call, Sources) : Found;
}

} // namespace tpc
