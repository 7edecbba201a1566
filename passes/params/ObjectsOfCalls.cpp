//===- ObjectsOfCalls.cpp -------------------------------------------------===//
#include "params/ObjectsOfCalls.h"

#include "llvm/ADT/SmallPtrSet.h"
#include "llvm/IR/Instructions.h"

using namespace llvm;

namespace tpc {

bool isOfOneCall(const Value *Pointer, ArrayRef<CallBase *> Calls,
                 PointsTo &Pointers) {
  const auto *Object = dyn_cast<Argument>(PointsTo::baseOf(Pointer));
  if (!Object || Calls.size() < 2)
    return false;
  SmallVector<Locations, 4> Passed;
  for (const CallBase *Call : Calls) {
    // A callback gets its arguments elsewhere.
    if (Call->getCalledFunction() != Object->getParent())
      continue;
    Locations Own =
        Pointers.resolve(Call->getArgOperand(Object->getArgNo()), false);
    if (Own.empty() || is_contained(Passed, Own))
      continue;
    if (any_of(Passed, [&](const Locations &Other) {
          return none_of(Other, [&](const Location &A) {
            return any_of(Own, [&](const Location &B) { return A.mayBe(B); });
          });
        }))
      return true;
    Passed.push_back(std::move(Own));
  }
  return false;
}

bool isLoadedForOneCall(const Value *V, ArrayRef<CallBase *> Calls,
                        PointsTo &Pointers) {
  constexpr unsigned Most = 32; // More are no formula that somebody wrote.
  SmallVector<const Value *, 8> Work{V};
  SmallPtrSet<const Value *, 8> Seen;
  while (!Work.empty() && Seen.size() < Most) {
    const auto *I = dyn_cast<Instruction>(Work.pop_back_val());
    if (!I || !Seen.insert(I).second)
      continue;
    if (const auto *Load = dyn_cast<LoadInst>(I)) {
      if (isOfOneCall(Load->getPointerOperand(), Calls, Pointers))
        return true;
    } else if (isa<BinaryOperator, UnaryOperator, CastInst, CmpInst, PHINode,
                   SelectInst, FreezeInst>(I)) {
      append_range(Work, I->operands());
    }
  }
  return false;
}

} // namespace tpc
