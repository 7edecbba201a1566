//===- Aliases.cpp --------------------------------------------------------===//
#include "memory/Aliases.h"

#include "support/Budget.h"
#include "support/Functions.h"

#include "llvm/ADT/SetVector.h"
#include "llvm/ADT/SmallPtrSet.h"
#include "llvm/Analysis/ValueTracking.h"
#include "llvm/IR/InstIterator.h"
#include "llvm/IR/IntrinsicInst.h"
#include "llvm/IR/Operator.h"
#include "llvm/Support/CommandLine.h"

using namespace llvm;

namespace tpc {

AnalysisKey AliasesAnalysis::Key;

Aliases AliasesAnalysis::run(Module &M, ModuleAnalysisManager &AM) {
  return Aliases(M, AM.getResult<SimpleCallGraph>(M),
                 AM.getResult<CalledBackAnalysis>(M),
                 AM.getResult<LocationTypesAnalysis>(M));
}

Aliases::Aliases(Module &M, const CallGraphResult &Calls, CalledBack &Back,
                 LocationTypes &Types)
    : Types(Types) {
  findEscaped(M, Calls, Back);
}

/// Of a pointer to MaxLocations places only the class is known, and such a one
/// leads to no local that does not escape. The argument of a function with very
/// many calls may be one, so what is passed as it counts as escaped.
static cl::opt<unsigned>
    MaxPassing("tpc-max-passing-calls", cl::Hidden, cl::init(24),
               cl::desc("Calls of a function whose argument is followed to "
                        "tell whether the address of a local escapes"));

namespace {
/// What happens to a local, or to what an argument points to.
struct Flow {
  bool Escapes = false; ///< its address: stored, returned, known to a library
  bool Holds = false;   ///< a pointer to an object is stored into it
  bool Copied = false;  ///< a part of it is the source of a memcpy or memmove
  SmallVector<const Argument *, 4> To;
};
} // namespace

/// True if what \p Call calls, without a body, can call a virtual function of
/// the object at \p Arg. That one gets the address from nowhere.
static bool isCalledBack(const CallBase &Call, const Use &Arg,
                         CalledBack &Back) {
  const CalledBack::Callable *Object = Back.handedAs(Call, Arg);
  return Object && (Object->Unknown || !Object->Virtual.empty());
}

/// True if the pointer \p V may lead to an object of the program: it is neither
/// null nor that of a class to its virtual functions.
static bool isOfObject(const Value &V) {
  if (!V.getType()->isPointerTy() || isa<ConstantPointerNull>(V))
    return false;
  return !getUnderlyingObject(&V)->getName().starts_with("_ZTV");
}

static Flow flowOf(const Value &Pointer, const CallGraphResult &Calls,
                   CalledBack &Back) {
  Flow Out;
  auto Pass = [&](const CallBase &Call, unsigned N) {
    for (const Function *F : Calls.callees(Call))
      if (N < F->arg_size() && Calls.callers(F).size() <= MaxPassing)
        Out.To.push_back(F->getArg(N));
      else
        Out.Escapes = true;
  };
  SmallVector<const Value *, 8> Work{&Pointer};
  SmallPtrSet<const Value *, 8> Seen;
  while (!Work.empty() && !Out.Escapes) {
    const Value *V = Work.pop_back_val();
    if (!Seen.insert(V).second)
      continue;
    for (const Use &U : V->uses()) {
      const auto *User = cast<Instruction>(U.getUser());
      const auto *Call = dyn_cast<CallBase>(User);
      // A merge of pointers is followed like one of them.
      if (isa<GEPOperator>(User) || isa<CastInst>(User) || isa<PHINode>(User) ||
          isa<SelectInst>(User) || isa<FreezeInst>(User) ||
          isa<InsertValueInst>(User) || isa<ExtractValueInst>(User))
        Work.push_back(User);
      else if (isa<ReturnInst>(User) ||
               (isa<StoreInst>(User) && U.getOperandNo() == 0))
        Out.Escapes = true;
      else if (const auto *Store = dyn_cast<StoreInst>(User))
        Out.Holds |= isOfObject(*Store->getValueOperand());
      else if (const auto *Copy = dyn_cast<MemTransferInst>(User))
        Out.Copied |= &U == &Copy->getRawSourceUse();
      else if (Call && Call->isArgOperand(&U)) {
        if (!Calls.callees(*Call).empty())
          Pass(*Call, Call->getArgOperandNo(&U));
        else
          Out.Escapes |= isCalledBack(*Call, U, Back);
      }
    }
  }
  return Out;
}

/// Adds to \p Found all that is passed as an argument in it, again and again.
static void addPassed(
    const DenseMap<const Argument *, SmallVector<const Value *, 4>> &PassedAs,
    SetVector<const Value *> &Found) {
  for (size_t N = 0; N < Found.size(); ++N)
    if (const auto *Arg = dyn_cast<Argument>(Found[N]))
      if (auto It = PassedAs.find(Arg); It != PassedAs.end())
        Found.insert(It->second.begin(), It->second.end());
}

/// A local escapes if its address is stored or returned, by its function or by
/// one that it is passed to, or if a library can call its virtual functions. An
/// argument leads to the locals that are passed as it, so passing alone makes
/// no unknown pointer.
///
/// Pointers in memory are not followed through memcpy. What a copy on the heap
/// holds, such as a lambda in a function object, is found by its class; so a
/// local that pointers are stored into, and a part of which is copied, counts
/// as escaped.
void Aliases::findEscaped(Module &M, const CallGraphResult &Calls,
                          CalledBack &Back) {
  DenseMap<const Argument *, SmallVector<const Value *, 4>> PassedAs;
  SetVector<const Value *> Escaping, Holding, Copied;
  auto Add = [&](const Value &Pointer) {
    Flow Of = flowOf(Pointer, Calls, Back);
    if (Of.Escapes) {
      Escaping.insert(&Pointer);
      return;
    }
    if (Of.Holds)
      Holding.insert(&Pointer);
    if (Of.Copied)
      Copied.insert(&Pointer);
    for (const Argument *To : Of.To)
      PassedAs[To].push_back(&Pointer);
  };
  for (Function &F : definedFunctions(M)) {
    if (Budget::isSpent())
      return;
    for (const Argument &Arg : F.args())
      if (Arg.getType()->isPointerTy())
        Add(Arg);
    for (const Instruction &I : instructions(F))
      if (isa<AllocaInst>(&I))
        Add(I);
  }
  addPassed(PassedAs, Holding);
  addPassed(PassedAs, Copied);
  for (const Value *Pointer : Copied)
    if (Holding.contains(Pointer))
      Escaping.insert(Pointer);
  addPassed(PassedAs, Escaping);
  Escaped.insert(Escaping.begin(), Escaping.end());
}

bool Aliases::isReachable(const Location &L) const {
  return !L.Root || !isa<AllocaInst>(L.Root) || Escaped.contains(L.Root);
}

bool Aliases::mayBe(const Location &A, const Location &B) const {
  if (!A.Root != !B.Root && !isReachable(A.Root ? A : B))
    return false;
  return A.mayBe(B);
}

std::optional<SmallVector<Step, 4>> Aliases::partOf(const Location &Object,
                                                    const Location &L) const {
  ArrayRef<Step> Path = L.Path;
  if (Object.Root && L.Root) {
    if (Object.Root != L.Root || !Object.RootItem.mayBe(L.RootItem) ||
        Path.size() < Object.Path.size() ||
        !StepPath::mayEqual(Path.take_front(Object.Path.size()), Object.Path))
      return std::nullopt;
    return SmallVector<Step, 4>(Path.drop_front(Object.Path.size()));
  }
  // A location with a root and one without can only meet if the first is
  // reachable.
  if (!isReachable(Object.Root ? Object : L))
    return std::nullopt;
  for (size_t K = 1; K <= Path.size() && !Object.Path.empty(); ++K) {
    ArrayRef<Step> Front = Path.take_front(K);
    if ((!Object.Root && endsWith(Front, Object.Path)) ||
        (!L.Root && endsWith(Object.Path, Front)))
      return SmallVector<Step, 4>(Path.drop_front(K));
  }
  if (!L.Root && !Path.empty() && Types.contains(Object, Path[0]))
    return SmallVector<Step, 4>(Path);
  return std::nullopt;
}

} // namespace tpc
