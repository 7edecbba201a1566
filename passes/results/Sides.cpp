//===- Sides.cpp ----------------------------------------------------------===//
#include "results/Sides.h"

#include "calls/SimpleCallGraph.h"
#include "params/Texts.h"

#include "llvm/IR/IntrinsicInst.h"
#include "llvm/Support/CommandLine.h"

using namespace llvm;

namespace tpc {

/// A configured value has few sources; one with more counts as measured.
static cl::opt<unsigned> MaxSources(
    "tpc-max-sources", cl::Hidden, cl::init(256),
    cl::desc("Sources of an operand that are looked at to tell a threshold"));

Sides::Sides(const ParameterUsage &Usage, const ParamCallFinder::Result &Reads,
             const CallGraphResult &Calls, PointsTo &Pointers,
             VisibleWrites &Writes,
             function_ref<bool(const ParameterComparison &)> IsExposed)
    : Usage(Usage), Reads(Reads), Calls(Calls), Pointers(Pointers),
      Writes(Writes) {
  for (const ParameterRead &Read : Reads) {
    Parameters.insert(Read.Call);
    Parameters.insert(Read.Values.begin(), Read.Values.end());
  }
  for (const ParameterComparison &C : Usage.Comparisons)
    if (C.Compare && IsExposed(C))
      ByCompare[C.Compare].push_back(&C);
}

/// True if \p Call gets a pointer to one of \p Variables, and not only to an
/// object that contains it: a node passes itself on all the time.
bool Sides::isHanded(const Instruction &Call,
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
Locations Sides::writtenBy(const Instruction &Write) const {
  Locations All;
  if (const Value *Pointer = getLoadStorePointerOperand(&Write))
    All = Pointers.resolve(Pointer, true);
  for (const ParameterRead &Read : Reads)
    if (Read.Call == &Write && Read.Target)
      append_range(All, Pointers.resolve(Read.Target, true));
  return All;
}

/// Adds what \p Load may read; false if anything but the stores of the program
/// to the same variable may be read.
bool Sides::addStored(const LoadInst &Load, Sources &Out) const {
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
bool Sides::addSources(const Value *V, Sources &Out) const {
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
    return addStored(*Load, Out);
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

/// True if \p V is computed from parameters and constants alone.
bool Sides::isConfigured(const Value *V) {
  auto [It, New] = Known.try_emplace(V, false);
  if (!New)
    return It->second;
  Sources Work{V};
  SmallPtrSet<const Value *, 16> Seen;
  while (!Work.empty()) {
    const Value *Next = Work.pop_back_val();
    if (isa<Constant>(Next) || Parameters.contains(Next) ||
        !Seen.insert(Next).second)
      continue;
    if (Seen.size() > MaxSources || !addSources(Next, Work))
      return false;
  }
  return Known[V] = true;
}

static const Value *stripCasts(const Value *V) {
  while (const auto *Cast = dyn_cast<CastInst>(V))
    V = Cast->getOperand(0);
  return V;
}

/// True if \p V is read from a member or global in which the program stores
/// constants alone: a threshold that somebody wrote down. A local is the
/// beginning of a computation.
bool Sides::isWrittenDown(const Value *V) const {
  const auto *Load = dyn_cast<LoadInst>(stripCasts(V));
  Sources From;
  return Load && addStored(*Load, From) && !From.empty() &&
         all_of(From, [](const Value *S) { return isa<Constant>(S); }) &&
         none_of(Pointers.resolve(Load->getPointerOperand(), true),
                 [](const Location &L) {
                   return isa_and_nonnull<AllocaInst>(L.Root);
                 });
}

/// The length of the path from the read to the predicate.
size_t Sides::lengthOf(const ParameterComparison &C) const {
  return C.Decisions.empty() ? 0 : Usage.pathTo(C.Decisions.front().Way).size();
}

/// Nobody knows whether two parameters whose names depend on the call are the
/// same.
bool Sides::isSameParameter(unsigned Read, unsigned Other) const {
  StringRef Name = Reads[Read].Name;
  return Read == Other ||
         (Name == Reads[Other].Name && !Name.contains(DynamicName));
}

static bool decides(const ParameterComparison &C, const Instruction &P) {
  return C.Compare == &P || any_of(C.Decisions, [&](const Decision &D) {
           return D.Predicate == &P;
         });
}

bool Sides::isOtherWay(const ParameterComparison &C,
                       const Instruction &Predicate) {
  return C.Compare && any_of(ByCompare.lookup(C.Compare),
                             [&](const ParameterComparison *Other) {
                               return Other->Operand != C.Operand &&
                                      decides(*Other, Predicate) &&
                                      isSameParameter(Other->Read, C.Read) &&
                                      lengthOf(*Other) < lengthOf(C) &&
                                      !isMeasured(*Other, Predicate);
                             });
}

bool Sides::isMeasured(const ParameterComparison &C,
                       const Instruction &Predicate) {
  if (!C.Compare)
    return false;
  const auto Others = ByCompare.lookup(C.Compare);
  // A formula with other values is no threshold where the other side is one.
  if (C.How.Variables && any_of(Others, [&](const ParameterComparison *Other) {
        return Other->Operand != C.Operand && !Other->How.Variables;
      }))
    return true;
  const Value *Own = C.Compare->getOperand(C.Operand);
  const Value *Other = C.Compare->getOperand(1 - C.Operand);
  // As where it is compared with a constant itself.
  if (C.How.Variables && isWrittenDown(Other))
    return true;
  const bool AreBoth = any_of(Others, [&](const ParameterComparison *O) {
    return O->Operand != C.Operand && decides(*O, Predicate);
  });
  // A value that was computed from the parameter alone is not measured,
  // whatever library computed it. Of a list, only the library knows. Most
  // counters are configured too: they count up from a constant.
  const bool IsPlain = C.How.kind() == Transform::None && C.How.Part.empty() &&
                       !isa<CallBase>(stripCasts(Own));
  if (!AreBoth && !(isa<Constant>(Other) && IsPlain))
    return false;
  // Elements are data where the other side is a parameter as a whole.
  const bool IsData =
      !C.How.Part.empty() && any_of(Others, [&](const ParameterComparison *O) {
        return O->Operand != C.Operand && O->How.Part.empty();
      });
  return !isConfigured(Own) && (IsData || isConfigured(Other));
}

} // namespace tpc
