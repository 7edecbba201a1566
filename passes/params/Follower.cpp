//===- Follower.cpp - Follows values --------------------------------------===//
//
// ParamUsageFinder.cpp handles a value that reaches a comparison.
//
//===----------------------------------------------------------------------===//
#include "params/Follower.h"

#include "params/Idioms.h"
#include "support/Budget.h"
#include "support/Compat.h"

#include "llvm/IR/IntrinsicInst.h"
#include "llvm/Support/CommandLine.h"

using namespace llvm;

namespace tpc {

/// Each level multiplies the states by the calls of a function. Below this
/// depth, a value that leaves a function is followed to all calls of it.
static cl::opt<unsigned> MaxCallDepth(
    "tpc-max-call-depth", cl::Hidden, cl::init(8),
    cl::desc(
        "Nested calls that are matched while a value is followed forward"));

const CallPath *Follower::enterCall(const CallBase *Call,
                                    const CallPath *Outer) {
  if (Outer && Outer->Depth == MaxCallDepth)
    Outer = nullptr;
  Paths.push_back(std::make_unique<CallPath>(
      CallPath{Call, Outer, Outer ? Outer->Depth + 1 : 1}));
  return Paths.back().get();
}

/// There are as many states as values times origins, which is quadratic in
/// generated code. Beyond the limit a flag is reported at its first origin
/// only.
static cl::opt<unsigned> MaxOrigins(
    "tpc-max-origins", cl::Hidden, cl::init(4096),
    cl::desc(
        "Origins of merged values that are distinguished for one parameter"));

/// \p Via is the instruction that passes the value on to S.V; none if S.V
/// itself computes it.
void Follower::push(State S, Instruction *Via) {
  Transform::KindTy Kind = S.How.kind();
  bool NewOrigin = S.Origin && !IsOutcome && SeenOrigins.size() < MaxOrigins &&
                   SeenOrigins.insert({S.V, S.Origin}).second;
  auto [It, New] = Seen.try_emplace(placeOf(S), Kind);
  if (!New && It->second <= Kind) {
    if (!NewOrigin)
      return;
    S.IsAnotherOrigin = true;
  } else {
    S.IsAnotherOrigin = false;
    It->second = Kind;
  }
  S.Way = Usage.Hops.size();
  Usage.Hops.push_back({S.V, Via ? Via : cast<Instruction>(S.V), Here});
  Work.push(std::move(S));
}

void Follower::stopAt(ValueEnd::KindTy Kind, Instruction *At) {
  Usage.Ends.push_back({Kind, ReadAtHand, At});
}

/// The next state. Skips a state that was since reached with simpler
/// arithmetic.
std::optional<Follower::State> Follower::takeNext() {
  while (std::optional<State> S = Work.pop())
    if ((S->IsAnotherOrigin || Seen.lookup(placeOf(*S)) >= S->How.kind()) &&
        !Budget::isSpent())
      return S;
  return std::nullopt;
}

Transform throughChoice(Transform How, const Instruction &I) {
  if (std::optional<Choice> C = choiceOf(I))
    How.call(C->Largest ? "max" : "min", C->Constant);
  return How;
}

/// True if \p A and \p B, of one idiom, point to the same variable: to the
/// same ones, if an object is one of several.
bool Follower::isOneVariable(const Value *A, const Value *B) const {
  if (isSameVariable(A, B))
    return true;
  Locations OfA = Pointers.resolve(A, true), OfB = Pointers.resolve(B, true);
  return !OfA.empty() && OfA.size() == OfB.size() &&
         all_of(OfA, [&](const Location &L) { return is_contained(OfB, L); });
}

/// True if \p A and \p B are the same local variable of the source, or the same
/// part of it.
static bool isSameLocal(const Value &A, const Value &B) {
  auto Records = variableRecords(const_cast<Value *>(&B));
  return any_of(variableRecords(const_cast<Value *>(&A)),
                [&](const DbgVariableRecord *R) {
                  return any_of(Records, [&](const DbgVariableRecord *Other) {
                    return DebugVariable(R) == DebugVariable(Other);
                  });
                });
}

/// True if \p V, a variable that was limited, is only compared, and may limit
/// others: it is a threshold of its own, and no command.
static bool isOnlyCompared(const Value &V) {
  constexpr unsigned Most = 64; // More are no threshold.
  SmallVector<const Value *, 8> Work{&V};
  SmallPtrSet<const Value *, 8> Seen;
  bool IsCompared = false;
  while (!Work.empty() && Seen.size() < Most) {
    const Value *Next = Work.pop_back_val();
    if (!Seen.insert(Next).second)
      continue;
    for (const User *U : Next->users()) {
      const auto *Store = dyn_cast<StoreInst>(U);
      const auto *Call = dyn_cast<IntrinsicInst>(U);
      const auto *I = cast<Instruction>(U);
      if (isa<CmpInst>(U))
        IsCompared = true;
      else if (isa<CastInst, UnaryOperator, BinaryOperator>(U) ||
               (Call && Call->doesNotAccessMemory() &&
                !Call->getType()->isVoidTy()))
        Work.push_back(U);
      else if (isa<PHINode, SelectInst>(U) && !limitedBy(*I).empty()) {
        // Limited once more, or the limit of another one.
        if (isSameLocal(*U, *Next))
          Work.push_back(U);
      } else if (!Store || !limitedBy(*Store))
        return false;
    }
  }
  return IsCompared && Work.empty();
}

/// True if the function of \p Merge, the value of a local variable, computes
/// another value of the same variable from it.
static bool isComputedFurther(const Instruction &Merge) {
  constexpr unsigned Most = 64;
  SmallVector<std::pair<const Instruction *, bool>, 8> Work{{&Merge, false}};
  SmallPtrSet<const Instruction *, 8> Seen[2];
  while (!Work.empty() && Seen[0].size() + Seen[1].size() < Most) {
    auto [Next, IsComputed] = Work.pop_back_val();
    if (!Seen[IsComputed].insert(Next).second)
      continue;
    if (IsComputed && isSameLocal(*Next, Merge))
      return true;
    for (const User *U : Next->users()) {
      const auto *Call = dyn_cast<IntrinsicInst>(U);
      const auto *I = cast<Instruction>(U);
      if (isa<CastInst, PHINode, SelectInst>(I))
        Work.push_back({I, IsComputed});
      else if (isa<UnaryOperator, BinaryOperator>(I) ||
               (Call && Call->doesNotAccessMemory() &&
                !Call->getType()->isVoidTy()))
        Work.push_back({I, true});
    }
  }
  return false;
}

/// True if \p Merge takes the smaller or larger of two values of which one is
/// not configured.
bool Follower::limitsMeasured(const Instruction &Merge) {
  return any_of(limitedBy(Merge), [&](const Limited &L) {
    return !Configuration.has(L.Compared);
  });
}

/// True if \p Merge takes the smaller or larger of the followed value, for
/// which \p IsOwn holds, and of a measured variable that it is then stored to,
/// as in `x = std::min(x, limit)`: what that is compared with later is not
/// compared with the limit. So is a variable of its own that the program
/// computes further. A variable that is only compared is a threshold.
bool Follower::limitsVariable(const Instruction &Merge,
                              function_ref<bool(const Value *)> IsOwn) {
  if (IsOutcome)
    return false;
  auto IsVariable = [&](const Limited &L) {
    if (isSameLocal(Merge, *L.Compared))
      return !isOnlyCompared(Merge);
    const auto *Load = dyn_cast<LoadInst>(stripCasts(L.Compared));
    const Value *Of = L.Side->getType()->isPointerTy() ? L.Side
                      : Load ? Load->getPointerOperand()
                             : nullptr;
    return Of && !Merge.use_empty() &&
           all_of(Merge.users(), [&](const User *U) {
             const auto *Store = dyn_cast<StoreInst>(U);
             return Store && isOneVariable(Store->getPointerOperand(), Of) &&
                    !isThresholdIn(*Store);
           });
  };
  return any_of(limitedBy(Merge), [&](const Limited &L) {
    return !IsOwn(L.Side) &&
           (IsVariable(L) ||
            (!isOnlyCompared(Merge) && isComputedFurther(Merge))) &&
           !Configuration.has(L.Compared);
  });
}

/// True if the variable that \p Store writes is only compared.
bool Follower::isThresholdIn(const StoreInst &Store) {
  ArrayRef<LoadInst *> Loads =
      describeStore(const_cast<StoreInst &>(Store)).Loads;
  return !Loads.empty() && all_of(Loads, [](const LoadInst *Load) {
    return Load->use_empty() || isOnlyCompared(*Load);
  });
}

/// The same by hand: `if (x > limit) x = limit`.
bool Follower::limitsVariable(const StoreInst &Store) {
  const Value *Compared = IsOutcome ? nullptr : limitedBy(Store);
  const auto *Load =
      Compared ? dyn_cast<LoadInst>(stripCasts(Compared)) : nullptr;
  return Load &&
         isOneVariable(Load->getPointerOperand(), Store.getPointerOperand()) &&
         !Configuration.has(Load) && !isThresholdIn(Store);
}

/// If a store may write to more variables than this, the points-to analysis has
/// lost track; comparisons found behind it are reported as doubtful.
static cl::opt<unsigned> MaxTargets(
    "tpc-max-store-targets", cl::Hidden, cl::init(16),
    cl::desc(
        "Variables that one store may write to before it is a blind spot"));

const Follower::Stored &Follower::describeStore(StoreInst &Store) {
  std::unique_ptr<Stored> &Known = Stores[&Store];
  if (!Known)
    Known = std::make_unique<Stored>(
        Stored{Pointers.resolve(Store.getPointerOperand(), true).size(),
               Writes.usesOf(Store, Store.getPointerOperand()),
               Pointers.partsOf(Store)});
  return *Known;
}

/// True if a function of the program moves the variable \p L on, as a mean or a
/// sum.
static bool isMovedOn(const Location &L, AccessIndex &Accesses) {
  return any_of(Accesses.writesOf(L).Own, [](const Instruction *Write) {
    const auto *Store = dyn_cast<StoreInst>(Write);
    return Store && isMovedOn(*Store);
  });
}

/// True if \p To is one variable that holds a threshold, whatever it was
/// computed from: not an element of an array or of a container, which holds
/// data, and no mean or sum that the program moves on elsewhere.
bool Follower::keepsFormula(const Stored &To) const {
  return To.Targets == 1 && all_of(To.Written, [&](const ScalarPart &P) {
           return !P.Size && P.Where.isOne() && !P.Where.isElement() &&
                  !isMovedOn(P.Where, Accesses);
         });
}

/// True if \p To is an element of an array or of a container, and no member of
/// one.
static bool isInArray(ArrayRef<ScalarPart> To) {
  return any_of(To, [](const ScalarPart &P) {
    return P.Where.item().Number == Nth::Any || P.Where.isElement();
  });
}

/// How a value ends that no load is known to read, written to \p Written.
ValueEnd::KindTy Follower::endWithoutLoad(ArrayRef<ScalarPart> Written) {
  return any_of(
             Written,
             [&](const ScalarPart &P) { return Accesses.isCopiedOn(P.Where); })
             ? ValueEnd::ManyTargets
             : ValueEnd::Unread;
}

/// The value goes on to the loads of the variable that it is stored to.
void Follower::store(const State &S, StoreInst &Store) {
  if (limitsVariable(Store))
    return;
  const Stored &To = describeStore(Store);
  if ((S.How.Variables && isMovedOn(Store)) ||
      (isMeasured(S.How) && !keepsFormula(To)))
    return stopAt(ValueEnd::Mixed, &Store);
  // A measured value that a parameter limits, and that is changed further.
  if (S.How.Limiting && !IsOutcome && !Configuration.has(S.V) &&
      any_of(
          To.Written,
          [&](const ScalarPart &P) { return isMovedOn(P.Where, Accesses); }) &&
      !isThresholdIn(Store))
    return stopAt(ValueEnd::Mixed, &Store);
  if (To.Targets == 0)
    stopAt(ValueEnd::UnknownPointer, &Store);
  else if (To.Targets > MaxTargets)
    stopAt(ValueEnd::ManyTargets, &Store);
  else if (To.Loads.empty() && !IsOutcome)
    stopAt(endWithoutLoad(To.Written), &Store);
  if (To.Loads.empty() && !S.In)
    return;
  State Next{S.V, S.How, nullptr, false, S.In};
  SmallVector<ScalarPart, 1> Written = To.Written;
  if (S.In && !Written.empty() && Written.front().Size) {
    erase_if(Written, [&](const ScalarPart &P) {
      return S.In->Low < P.Low || S.In->Low + S.In->Size > P.Low + P.Size;
    });
    if (Written.empty())
      return stopAt(ValueEnd::Mixed, &Store);
    // The whole scalar, or a bit field in it.
    ScalarPart Own = Written.front();
    Next.In.reset();
    if (S.In->Size < Own.Size)
      Next.In = {S.In->Low - Own.Low, S.In->Size};
  }
  load(Next, Store, Written, To.Loads);
}

/// Follows the value of \p S, as stored in the scalar, to \p Loads, which read
/// what \p Write has written to \p Written.
void Follower::load(const State &S, Instruction &Write,
                    ArrayRef<ScalarPart> Written, ArrayRef<LoadInst *> Loads) {
  bool WasWide = any_of(Written, [](const ScalarPart &P) { return P.Size; });
  for (LoadInst *Load : Loads) {
    State Next{Load, throughChoice(S.How, *Load), nullptr, S.Direct};
    auto &Known = Parts[Load];
    if (!Known)
      Known =
          std::make_unique<SmallVector<ScalarPart, 1>>(Pointers.partsOf(*Load));
    ArrayRef<ScalarPart> Read = *Known;
    // One of several values, such as the result of std::min, is no formula.
    if (isMeasured(S.How) && Read.size() > 1) {
      stopAt(ValueEnd::Mixed, Load);
      continue;
    }
    // A list of what was measured, some of it limited by a parameter.
    if (S.How.Limiting && !IsOutcome &&
        (isInArray(Written) || isInArray(Read)) && !Configuration.has(S.V)) {
      stopAt(ValueEnd::Mixed, Load);
      continue;
    }
    if (Read.size() > 1 && limitsVariable(*Load, [&](const Value *Side) {
          return any_of(Pointers.resolve(Side, true), [&](const Location &L) {
            return any_of(Written, [&](const ScalarPart &From) {
              return Accesses.reaches(From.Where, L);
            });
          });
        }))
      continue;
    if (Read.size() > 1 && !choiceOf(*Load) && limitsMeasured(*Load))
      Next.How.Merged = Next.How.Limiting = true;
    bool IsWide = any_of(Read, [](const ScalarPart &P) { return P.Size; });
    if (!WasWide && !IsWide) {
      Next.In = S.In;
      push(std::move(Next), &Write);
      continue;
    }
    // The scalar that was written, wherever it is in the value that is read.
    for (const ScalarPart &To : Read) {
      if (none_of(Written, [&](const ScalarPart &From) {
            return Accesses.reaches(From.Where, To.Where);
          }))
        continue;
      Next.In = S.In;
      if (To.Size)
        Next.In =
            S.In ? Bits{To.Low + S.In->Low, S.In->Size} : Bits{To.Low, To.Size};
      push(Next, &Write);
      break;
    }
  }
}

/// True for intrinsics that return their first operand.
static bool isCopy(const Instruction &I, const Use &U) {
  const auto *Call = dyn_cast<IntrinsicInst>(&I);
  if (!Call || U.getOperandNo() != 0)
    return false;
  switch (Call->getIntrinsicID()) {
  case Intrinsic::expect:
  case Intrinsic::expect_with_probability:
  case Intrinsic::annotation:
  case Intrinsic::ssa_copy:
    return true;
  default:
    return false;
  }
}

/// Follows the value at \p U if its user only moves it within a register. False
/// if the user does something else, or loses the value.
bool Follower::followRepacked(const State &S, Use &U) {
  Repacked R = repack(U, S.In);
  if (R.Kind == Repacked::None)
    return false;
  if (R.Kind == Repacked::Gone)
    return true;
  std::optional<Bits> In;
  if (R.Kind == Repacked::Part)
    In = R.In;
  push({cast<Instruction>(U.getUser()), S.How, S.Path, S.Direct && !In && !S.In,
        In});
  return true;
}

/// Follows the value at \p U to where it is still the same value: casts, phis,
/// variables, arguments, results. False if \p U does something else with it.
bool Follower::carry(const State &S, Use &U) {
  auto *I = cast<Instruction>(U.getUser());
  // A formula belongs to the function that computes it: what it hands on or
  // returns, or merges with other values, is data.
  if (isMeasured(S.How) && (isa<PHINode, SelectInst, ReturnInst>(I) ||
                            (isa<CallBase>(I) && !isCopy(*I, U))))
    return false;
  if (isa<CastInst>(I) || isa<FreezeInst>(I) || isCopy(*I, U)) {
    push({I, S.How, S.Path, S.Direct, S.In, S.Origin});
    return true;
  }
  if (const auto *Phi = dyn_cast<PHINode>(I)) {
    auto [It, New] = Stepped.try_emplace(Phi);
    if (New)
      It->second = isStepped(*Phi);
    if (It->second)
      return false;
  }
  if (isa<PHINode>(I) || (isa<SelectInst>(I) && U.getOperandNo() != 0)) {
    Transform How = S.How;
    How.Merged = true;
    How.Limiting |= limitsMeasured(*I);
    push({I, How, S.Path, false, S.In, S.Origin ? S.Origin : S.V});
    return true;
  }
  if (auto *Store = dyn_cast<StoreInst>(I)) {
    if (U.getOperandNo() == 0)
      store(S, *Store);
    return true;
  }
  if (auto *Call = dyn_cast<CallBase>(I); Call && !isa<IntrinsicInst>(Call)) {
    SmallVector<Function *, 1> Callees = Calls.callees(*Call);
    if (Callees.empty() || !Call->isArgOperand(&U))
      return false;
    for (Function *Callee : Callees)
      if (Call->getArgOperandNo(&U) < Callee->arg_size())
        push({Callee->getArg(Call->getArgOperandNo(&U)), S.How,
              enterCall(Call, S.Path), false, S.In},
             Call);
    return true;
  }
  if (isa<ReturnInst>(I)) {
    if (S.Path)
      push({const_cast<CallBase *>(S.Path->Call), S.How, S.Path->Outer, false,
            S.In},
           I);
    else
      for (CallBase *Call : Calls.callers(I->getFunction()))
        push({Call, S.How, nullptr, false, S.In}, I);
    return true;
  }
  return false;
}

} // namespace tpc
