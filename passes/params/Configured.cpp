//===- Configured.cpp -----------------------------------------------------===//
#include "params/Configured.h"

#include "calls/SimpleCallGraph.h"

#include "llvm/IR/Instructions.h"
#include "llvm/IR/IntrinsicInst.h"
#include "llvm/Support/CommandLine.h"

using namespace llvm;

namespace tpc {

/// A configured value has few sources; one with more counts as measured.
static cl::opt<unsigned> MaxSources(
    "tpc-max-sources", cl::Hidden, cl::init(256),
    cl::desc("Sources of an operand that are looked at to tell a threshold"));

const Value *stripCasts(const Value *V) {
  while (const auto *Cast = dyn_cast<CastInst>(V))
    V = Cast->getOperand(0);
  return V;
}

Configured::Configured(const ParamCallFinder::Result &Reads,
                       const CallGraphResult &Calls, PointsTo &Pointers,
                       VisibleWrites &Writes)
    : Reads(Reads), Calls(Calls), Pointers(Pointers), Writes(Writes) {
  for (const ParameterRead &Read : Reads) {
    Parameters.insert(Read.Call);
    Parameters.insert(Read.Values.begin(), Read.Values.end());
  }
}

/// True if \p Call gets a pointer to one of \p Variables, and not only to an
/// object that contains it: a node passes itself on all the time.
bool Configured::isHanded(const Instruction &Call,
                          ArrayRef<Location> Variables) const {
  const auto *To = dyn_cast<CallBase>(&Call);
  return !To || any_of(To->args(), [&](const Use &Arg) {
    return Arg->getType()->isPointerTy() &&
           any_of(Pointers.resolve(Arg, false), [&](const Location &A) {
             return any_of(Variables, [&](const Location &Variable) {
               return Variable.mayEqual(A);
             });
           });
  });
}

/// The variables that \p Write, a store or a parameter read, writes.
Locations Configured::writtenBy(const Instruction &Write) const {
  Locations All;
  if (const Value *Pointer = getLoadStorePointerOperand(&Write))
    All = Pointers.resolve(Pointer, true);
  for (const ParameterRead &Read : Reads)
    if (Read.Call == &Write && Read.Target)
      append_range(All, Pointers.resolve(Read.Target, true));
  return All;
}

/// Adds what \p Load may read; false if anything but the stores of the program
/// to the same variable may be read. If it is not known who calls a callback,
/// its message can be one of the program's; it counts as such unless \p Surely.
bool Configured::addStored(const LoadInst &Load, Sources &Out,
                           bool Surely) const {
  if (Surely && Writes.mayBeReceived(Load.getPointerOperand()))
    return false;
  Locations From = Pointers.resolve(Load.getPointerOperand(), true);
  if (From.empty())
    return false;
  ArrayRef<Instruction *> Found = Writes.definitionsOf(Load);
  for (const Instruction *Write : Found) {
    if (Parameters.contains(Write))
      continue;
    if (const auto *Store = dyn_cast<StoreInst>(Write))
      Out.push_back(Store->getValueOperand());
    else if (isHanded(*Write, From))
      return false;
  }
  // The argument of a callback counts as any object of its class, even one that
  // is part of a larger object. That is too wide here.
  return all_of(From, [&](const Location &A) {
    return any_of(Found, [&](const Instruction *Write) {
      return any_of(writtenBy(*Write), [&](const Location &B) {
        return (!A.Root == !B.Root || A.Path.size() == B.Path.size()) &&
               A.mayBe(B);
      });
    });
  });
}

/// Adds what \p V is computed from; false if that is not known, or comes from
/// outside.
bool Configured::addSources(const Value *V, Sources &Out, bool Surely) const {
  if (const auto *Arg = dyn_cast<Argument>(V)) {
    const Function &F = *Arg->getParent();
    ArrayRef<CallBase *> Callers = Calls.callers(&F);
    if (Callers.empty() || !Calls.allCallsKnown(F))
      return false;
    for (const CallBase *Call : Callers) {
      if (Arg->getArgNo() >= Call->arg_size())
        return false;
      Out.push_back(Call->getArgOperand(Arg->getArgNo()));
    }
    return true;
  }
  if (const auto *Load = dyn_cast<LoadInst>(V))
    return addStored(*Load, Out, Surely);
  if (const auto *Call = dyn_cast<CallBase>(V)) {
    if (isa<IntrinsicInst>(Call) && Call->doesNotAccessMemory()) {
      append_range(Out, Call->args());
      return true;
    }
    SmallVector<Function *, 1> Callees = Calls.callees(*Call);
    for (const Function *F : Callees)
      for (const BasicBlock &BB : *F)
        if (const auto *Return = dyn_cast<ReturnInst>(BB.getTerminator())) {
          // A callee that is called with another type may return nothing.
          if (!Return->getReturnValue())
            return false;
          Out.push_back(Return->getReturnValue());
        }
    return !Callees.empty();
  }
  if (const auto *Select = dyn_cast<SelectInst>(V)) {
    Out.append({Select->getTrueValue(), Select->getFalseValue()});
    return true;
  }
  if (!isa<CastInst>(V) && !isa<PHINode>(V) && !isa<FreezeInst>(V) &&
      !isa<BinaryOperator>(V) && !isa<UnaryOperator>(V))
    return false;
  append_range(Out, cast<User>(V)->operands());
  return true;
}

bool Configured::has(const Value *V, bool Surely) {
  auto [It, New] = Known[Surely].try_emplace(V, false);
  if (!New)
    return It->second;
  Sources Work{V};
  SmallPtrSet<const Value *, 16> Seen;
  while (!Work.empty()) {
    const Value *Next = Work.pop_back_val();
    if (isa<Constant>(Next) || Parameters.contains(Next) ||
        !Seen.insert(Next).second)
      continue;
    if (Seen.size() > MaxSources || !addSources(Next, Work, Surely))
      return false;
  }
  return Known[Surely][V] = true;
}

bool Configured::isWrittenDown(const Value *V) const {
  const auto *Load = dyn_cast<LoadInst>(stripCasts(V));
  Sources From;
  return Load && addStored(*Load, From, /*Surely=*/false) && !From.empty() &&
         all_of(From, [](const Value *S) { return isa<Constant>(S); }) &&
         none_of(Pointers.resolve(Load->getPointerOperand(), true),
                 [](const Location &L) {
                   return isa_and_nonnull<AllocaInst>(L.Root);
                 });
}

} // namespace tpc
