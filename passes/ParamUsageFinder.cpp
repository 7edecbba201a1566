//===- ParamUsageFinder.cpp -----------------------------------------------===//
#include "ParamUsageFinder.h"

#include "Budget.h"
#include "ClassObjectAccess.h"
#include "Idioms.h"
#include "IfStatements.h"
#include "ParamCallFinder.h"
#include "Print.h"
#include "Registers.h"
#include "SimpleCallGraph.h"
#include "TextUsage.h"

#include "llvm/ADT/DenseMap.h"
#include "llvm/IR/IntrinsicInst.h"
#include "llvm/IR/Module.h"

#include <array>

using namespace llvm;

namespace tpc {

AnalysisKey ParamUsageFinder::Key;

unsigned ParameterUsage::lost() const {
  return count_if(Ends, [](const ValueEnd &E) {
    return E.Kind == ValueEnd::Mixed || E.Kind == ValueEnd::NoNumber;
  });
}

SmallVector<Hop, 16> ParameterUsage::pathTo(unsigned Last) const {
  SmallVector<Hop, 16> Path;
  for (unsigned N = Last; N != Hop::None; N = Hops[N].From)
    Path.push_back(Hops[N]);
  std::reverse(Path.begin(), Path.end());
  return Path;
}

//===----------------------------------------------------------------------===//
// The way forward
//===----------------------------------------------------------------------===//

/// The calls that a value went into, the last one first.
struct CallPath {
  const CallBase *Call;
  const CallPath *Outer;
  unsigned Depth;
};

/// Follows values forward. Two kinds: a parameter's value, up to the
/// comparisons, and a comparison's outcome, up to the predicates.
class Follower {
public:
  Follower(Module &M, ModuleAnalysisManager &AM)
      : Calls(AM.getResult<SimpleCallGraph>(M)),
        Access(AM.getResult<ClassObjectAccess>(M)),
        Reads(AM.getResult<ParamCallFinder>(M)),
        Rules(AM.getResult<RuleAnalysis>(M)), Texts(M, Access, Rules) {}

  ParameterUsage run();

private:
  struct State {
    Value *V;
    Transform How;
    const CallPath *Path;
    bool Direct; ///< of an outcome: see Decision
    /// Where V is several numbers in one: the bits that are this one.
    std::optional<Bits> In = std::nullopt;
    /// Where control flow has merged V with other values: the last value
    /// before that.
    Value *Origin = nullptr;
    /// V was come to before, from another Origin: what it decides stands at
    /// this one as well.
    bool IsAnotherOrigin = false;
    unsigned Way = Hop::None; ///< number of the hop that led here
  };
  /// By kind of Transform: what comes to a place in several ways is followed on
  /// from there with the simplest arithmetic.
  class Worklist {
  public:
    void push(State S) {
      Transform::KindTy Kind = S.How.kind();
      ByKind[Kind].push_back(std::move(S));
    }
    std::optional<State> pop() {
      for (SmallVector<State, 16> &Of : ByKind)
        if (!Of.empty())
          return Of.pop_back_val();
      return std::nullopt;
    }

  private:
    std::array<SmallVector<State, 16>, Transform::Expression + 1> ByKind;
  };

  void followRead(unsigned N);
  void decided(const State &S, Instruction &Predicate, unsigned Read);
  void useOfMerged(const State &S, Use &U, unsigned Read);
  void useOfValue(const State &S, Use &U, unsigned Read);
  void compared(const State &S, CmpInst &Compare, unsigned Operand,
                unsigned Read);
  void flag(const State &S, Value *V, Decision D, unsigned Read,
            bool IsOperand = false);
  void followText(unsigned N);
  SmallVector<Decision, 2> followOutcome(Value *Outcome, const CallPath *Path);
  bool repacked(const State &S, Use &U);
  bool carry(const State &S, Use &U);
  void load(const State &S, Instruction &Write, ArrayRef<ScalarPart> Written,
            ArrayRef<LoadInst *> Loads);
  /// What a store writes to, whatever the value.
  struct Stored {
    size_t Targets;
    SmallVector<LoadInst *, 8> Loads;
    SmallVector<ScalarPart, 1> Written;
  };
  const Stored &stored(StoreInst &Store);
  void store(const State &S, StoreInst &Store);
  void end(ValueEnd::KindTy Kind, Instruction *At);
  /// Nobody asks for the way of a value that is compared nowhere.
  void forgetHops(size_t From) {
    Usage.Hops.erase(Usage.Hops.begin() + From, Usage.Hops.end());
  }
  void push(State S, Instruction *Via = nullptr);
  const CallPath *into(const CallBase *Call, const CallPath *Outer);
  static std::pair<const Value *, const CallBase *> placeOf(const State &S) {
    return {S.V, S.Path ? S.Path->Call : nullptr};
  }
  std::optional<State> next();

  const CallGraphResult &Calls;
  const AccessResult &Access;
  const ParamCallFinder::Result &Reads;
  const RuleMatches &Rules;
  const TextUsage Texts;

  // Very many values may come to one place.
  DenseMap<const StoreInst *, std::unique_ptr<Stored>> Stores;
  DenseMap<const LoadInst *, std::unique_ptr<SmallVector<ScalarPart, 1>>> Parts;

  ParameterUsage Usage;
  Worklist Work;
  unsigned ReadAtHand = 0;
  bool IsOutcome = false;    ///< what is followed is not the value itself
  unsigned Here = Hop::None; ///< hop that led to the state at hand
  /// The simplest arithmetic with which a value was come to, by each call.
  DenseMap<std::pair<const Value *, const CallBase *>, Transform::KindTy> Seen;
  DenseSet<std::pair<const Value *, const Value *>> SeenOrigins;
  SmallVector<std::unique_ptr<CallPath>, 16> Paths;
};

/// Calls inside calls that are told apart; deeper ones come out anywhere.
static constexpr unsigned MaxCallDepth = 8;

const CallPath *Follower::into(const CallBase *Call, const CallPath *Outer) {
  if (Outer && Outer->Depth == MaxCallDepth)
    Outer = nullptr;
  Paths.push_back(std::make_unique<CallPath>(
      CallPath{Call, Outer, Outer ? Outer->Depth + 1 : 1}));
  return Paths.back().get();
}

/// Places of merged values that are told apart for one read.
static constexpr unsigned MaxOrigins = 4096;

/// \p Via is the instruction that brings the value to S.V; none where S.V
/// computes it itself.
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

void Follower::end(ValueEnd::KindTy Kind, Instruction *At) {
  Usage.Ends.push_back({Kind, ReadAtHand, At});
}

/// The state to go on from; one that was come to more simply is done with.
std::optional<Follower::State> Follower::next() {
  while (std::optional<State> S = Work.pop())
    if ((S->IsAnotherOrigin || Seen.lookup(placeOf(*S)) >= S->How.kind()) &&
        !Budget::isSpent())
      return S;
  return std::nullopt;
}

/// \p How, and what \p I, a merge or a load, makes of it where it takes the
/// value or a constant, whichever is smaller or larger.
static Transform throughChoice(Transform How, const Instruction &I) {
  if (std::optional<Choice> C = choiceOf(I))
    How.call(C->Largest ? "max" : "min", C->Constant);
  return How;
}

/// More variables that a store may write to are more than anybody meant.
static constexpr unsigned ManyTargets = 16;

const Follower::Stored &Follower::stored(StoreInst &Store) {
  std::unique_ptr<Stored> &Known = Stores[&Store];
  if (!Known)
    Known = std::make_unique<Stored>(
        Stored{Access.resolve(Store.getPointerOperand(), true).size(),
               Access.usesOf(Store, Store.getPointerOperand()),
               Access.partsOf(Store)});
  return *Known;
}

/// A value goes on to the loads of the variable that it is stored to.
void Follower::store(const State &S, StoreInst &Store) {
  const Stored &To = stored(Store);
  if (To.Targets == 0)
    end(ValueEnd::UnknownPointer, &Store);
  else if (To.Targets > ManyTargets)
    end(ValueEnd::ManyTargets, &Store);
  else if (To.Loads.empty() && !IsOutcome)
    end(ValueEnd::Unread, &Store);
  if (To.Loads.empty() && !S.In)
    return;
  State Next{S.V, S.How, nullptr, false, S.In};
  SmallVector<ScalarPart, 1> Written = To.Written;
  if (S.In && !Written.empty() && Written.front().Size) {
    erase_if(Written, [&](const ScalarPart &P) {
      return S.In->Low < P.Low || S.In->Low + S.In->Size > P.Low + P.Size;
    });
    if (Written.empty())
      return end(ValueEnd::Mixed, &Store);
    // The whole scalar, or a bit field in it.
    ScalarPart Own = Written.front();
    Next.In.reset();
    if (S.In->Size < Own.Size)
      Next.In = {S.In->Low - Own.Low, S.In->Size};
  }
  load(Next, Store, Written, To.Loads);
}

/// The value of \p S, as it stands in the scalar, goes on to \p Loads, which
/// read what \p Write has put to
/// \p Written.
void Follower::load(const State &S, Instruction &Write,
                    ArrayRef<ScalarPart> Written, ArrayRef<LoadInst *> Loads) {
  bool WasWide = any_of(Written, [](const ScalarPart &P) { return P.Size; });
  for (LoadInst *Load : Loads) {
    State Next{Load, throughChoice(S.How, *Load), nullptr, S.Direct};
    auto &Known = Parts[Load];
    if (!Known)
      Known =
          std::make_unique<SmallVector<ScalarPart, 1>>(Access.partsOf(*Load));
    ArrayRef<ScalarPart> Read = *Known;
    bool IsWide = any_of(Read, [](const ScalarPart &P) { return P.Size; });
    if (!WasWide && !IsWide) {
      Next.In = S.In;
      push(std::move(Next), &Write);
      continue;
    }
    // The scalar that was written, wherever it stands in what is read.
    for (const ScalarPart &To : Read) {
      if (none_of(Written, [&](const ScalarPart &From) {
            return Access.reaches(From.Where, To.Where);
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

/// True for the intrinsics that give back their first operand.
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

/// Carries what is at \p U on where the user only moves it in a register. False
/// where it does something else, or would lose it.
bool Follower::repacked(const State &S, Use &U) {
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

/// Carries what is at \p U on to where it is the same value still: casts,
/// merges, variables, arguments, results. False where \p U does something
/// else with it.
bool Follower::carry(const State &S, Use &U) {
  auto *I = cast<Instruction>(U.getUser());
  if (isa<CastInst>(I) || isa<FreezeInst>(I) || isCopy(*I, U)) {
    push({I, S.How, S.Path, S.Direct, S.In, S.Origin});
    return true;
  }
  if (isa<PHINode>(I) || (isa<SelectInst>(I) && U.getOperandNo() != 0)) {
    push({I, S.How, S.Path, false, S.In, S.Origin ? S.Origin : S.V});
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
              into(Call, S.Path), false, S.In},
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

/// True for the operations that make one truth value of two.
static bool isLogical(const Instruction &I) {
  return I.getOpcode() == Instruction::And ||
         I.getOpcode() == Instruction::Or || I.getOpcode() == Instruction::Xor;
}

/// True where \p I decides by \p U.
static bool decidesBy(const Instruction &I, const Use &U) {
  return isPredicate(I) && U.get() == conditionOf(I) &&
         !(isa<SelectInst>(I) && U.getOperandNo() != 0);
}

/// The predicates that \p Outcome, a truth value, decides.
SmallVector<Decision, 2> Follower::followOutcome(Value *Outcome,
                                                 const CallPath *Path) {
  Worklist OuterWork = std::exchange(Work, {});
  auto OuterSeen = std::move(Seen);
  unsigned OuterHere = Here;
  Seen.clear();
  IsOutcome = true;
  size_t HopsBefore = Usage.Hops.size();
  SmallVector<Decision, 2> Found;
  push({Outcome, {}, Path, true});
  while (std::optional<State> At = next()) {
    const State &S = *At;
    Here = S.Way;
    for (Use &U : S.V->uses()) {
      auto *I = dyn_cast<Instruction>(U.getUser());
      if (!I)
        continue;
      if (!S.In && decidesBy(*I, U))
        Found.push_back({I, S.Direct, S.Way});
      else if (repacked(S, U))
        continue;
      else if (S.In && !carry(S, U))
        end(ValueEnd::Outcome, I);
      else if (S.In)
        continue;
      else if (isLogical(*I) || isa<ICmpInst>(I))
        push({I, {}, S.Path, S.Direct});
      else if (!carry(S, U))
        end(ValueEnd::Outcome, I);
    }
  }
  Work = std::move(OuterWork);
  Seen = std::move(OuterSeen);
  Here = OuterHere;
  IsOutcome = false;
  if (Found.empty())
    forgetHops(HopsBefore);
  return Found;
}

/// \p V, made of what \p S follows, decides \p D by itself.
void Follower::flag(const State &S, Value *V, Decision D, unsigned Read,
                    bool IsOperand) {
  ParameterComparison C;
  // An argument has no place of its own: there the flag stands at the branch.
  C.IsOperand = IsOperand && isa<Instruction>(V);
  C.How = S.How;
  C.ByArgument = S.Path && Calls.callers(D.Predicate->getFunction()).size() > 1;
  C.Read = Read;
  C.Flag = V;
  C.Decisions.push_back(D);
  Usage.Comparisons.push_back(std::move(C));
}

/// True where \p I is what `&&` or `||` makes of its last operand \p U: all
/// other ways to it are decided already.
static bool isShortCircuit(const Instruction &I, const Use &U) {
  const auto *Phi = dyn_cast<PHINode>(&I);
  return Phi && Phi->getType()->isIntegerTy(1) &&
         Phi->getNumIncomingValues() > 1 &&
         all_of(Phi->incoming_values(),
                [&](const Use &In) { return &In == &U || isa<Constant>(In); });
}

/// True where \p Compare only asks whether an operand is not zero, as C++ does
/// where a number stands as a condition.
static bool asksForNonZero(const CmpInst &Compare, unsigned Operand) {
  const auto *Zero = dyn_cast<Constant>(Compare.getOperand(1 - Operand));
  return Zero && Zero->isZeroValue() &&
         (Compare.getPredicate() == CmpInst::ICMP_NE ||
          Compare.getPredicate() == CmpInst::FCMP_UNE);
}

void Follower::compared(const State &S, CmpInst &Compare, unsigned Operand,
                        unsigned Read) {
  if (Compare.getOperand(0) == Compare.getOperand(1) ||
      Compare.getOperand(0)->getType()->isPtrOrPtrVectorTy())
    return;
  // Whether it is a number is a question of its own.
  if (Compare.getPredicate() == CmpInst::FCMP_UNO ||
      Compare.getPredicate() == CmpInst::FCMP_ORD)
    return end(ValueEnd::Mixed, &Compare);
  if (S.How.kind() == Transform::None && asksForNonZero(Compare, Operand)) {
    for (const Decision &D : followOutcome(&Compare, S.Path))
      flag(S, &Compare, D, Read, /*IsOperand=*/!D.Direct);
    return;
  }
  ParameterComparison C;
  C.Read = Read;
  C.Compare = &Compare;
  C.Operand = Operand;
  C.How = S.How;
  C.ByArgument = S.Path && Calls.callers(Compare.getFunction()).size() > 1;
  C.Decisions = followOutcome(&Compare, S.Path);
  Usage.Comparisons.push_back(std::move(C));
}

/// The value itself decides \p Predicate.
void Follower::decided(const State &S, Instruction &Predicate, unsigned Read) {
  if (S.How.kind() == Transform::None || isa<SwitchInst>(Predicate))
    flag(S, S.Origin ? S.Origin : S.V, {&Predicate, !S.Origin, S.Way}, Read,
         /*IsOperand=*/S.Origin != nullptr);
}

/// Of a merged value that was followed from another of its origins already
/// only what it decides is asked.
void Follower::useOfMerged(const State &S, Use &U, unsigned Read) {
  auto *I = dyn_cast<Instruction>(U.getUser());
  if (!I || S.In)
    return;
  if (decidesBy(*I, U))
    decided(S, *I, Read);
  else if (const auto *Cast = dyn_cast<CastInst>(I))
    push({I, applyCast(S.How, *Cast), S.Path, S.Direct, S.In, S.Origin});
  else if ((isa<PHINode>(I) && !isShortCircuit(*I, U)) || isa<SelectInst>(I) ||
           isa<FreezeInst>(I))
    carry(S, U);
}

void Follower::useOfValue(const State &S, Use &U, unsigned Read) {
  auto *I = dyn_cast<Instruction>(U.getUser());
  if (!I)
    return;
  if (S.IsAnotherOrigin)
    return useOfMerged(S, U, Read);
  if (repacked(S, U))
    return;
  if (S.In) {
    if (!carry(S, U))
      end(ValueEnd::Mixed, I);
    return;
  }
  if (auto *Compare = dyn_cast<CmpInst>(I))
    return compared(S, *Compare, U.getOperandNo(), Read);
  if (decidesBy(*I, U))
    return decided(S, *I, Read);
  if (isLogical(*I) && S.V->getType()->isIntegerTy(1)) {
    for (Decision D : followOutcome(I, S.Path))
      flag(S, S.V, D, Read, /*IsOperand=*/!D.Direct);
    return;
  }
  if (isShortCircuit(*I, U) && S.How.kind() == Transform::None &&
      isa<Instruction>(S.V)) {
    for (Decision D : followOutcome(I, S.Path))
      flag(S, S.V, {D.Predicate, false, D.Way}, Read, /*IsOperand=*/true);
    return;
  }
  if (const auto *Cast = dyn_cast<CastInst>(I))
    return push({I, applyCast(S.How, *Cast), S.Path, S.Direct, S.In, S.Origin});
  if (choiceOf(*I))
    return push({I, throughChoice(S.How, *I), S.Path, S.Direct});
  if (auto *Call = dyn_cast<CallBase>(I))
    if (const Rule *Row = Rules.match(*Call);
        Row && Row->Kind == Rule::Held && Row->Relation == "into" &&
        argument(*Call, *Row, Row->Value) == S.V) {
      for (CallBase *Out : Texts.numbersFrom(*Call, *Row))
        push({Out, S.How, nullptr, false}, Call);
      return;
    }
  if (carry(S, U))
    return;
  if (std::optional<Transform> T = apply(S.How, *I, S.V, squareOf(*I)))
    push({I, std::move(*T), S.Path, S.Direct});
  else if (!isa<IntrinsicInst>(I) || !I->getType()->isVoidTy())
    end(ValueEnd::Mixed, I);
}

/// True for the types whose values are compared as numbers.
static bool isNumber(StringRef Type) {
  static constexpr StringRef Numbers[] = {
      "bool",  "char",           "signed char", "unsigned char",
      "short", "unsigned short", "int",         "unsigned int",
      "long",  "unsigned long",  "long long",   "unsigned long long",
      "float", "double",         "long double"};
  return is_contained(Numbers, Type);
}

/// Text is followed as an object: what is called with it compares or copies it.
void Follower::followText(unsigned N) {
  const ParameterRead &Read = Reads[N];
  const Value *Object = Read.Target;
  if (!Object && Read.Call->hasStructRetAttr())
    Object = Read.Call->getArgOperand(0);
  if (!Object)
    return end(ValueEnd::NoNumber, Read.Call);
  Seen.clear();
  TextUsage::Found Found = Texts.comparisonsOf(Object);
  for (unsigned Lost = 0; Lost < Found.Lost; ++Lost)
    end(ValueEnd::Mixed, Read.Call);
  for (const TextComparison &T : Found.Comparisons) {
    ParameterComparison C;
    C.Read = N;
    C.Flag = T.Outcome;
    C.TextRelation = T.Relation;
    C.ByArgument =
        T.ByArgument && Calls.callers(T.Outcome->getFunction()).size() > 1;
    C.Decisions = followOutcome(T.Outcome, nullptr);
    Usage.Comparisons.push_back(std::move(C));
  }
}

void Follower::followRead(unsigned N) {
  const ParameterRead &R = Reads[N];
  ReadAtHand = N;
  size_t HopsBefore = Usage.Hops.size(), Before = Usage.Comparisons.size();
  Here = Hop::None;
  if (isText(R.Type))
    return followText(N);
  if (!isNumber(R.Type))
    return end(ValueEnd::NoNumber, R.Call);
  Seen.clear();
  SeenOrigins.clear();
  for (Value *V : R.Values)
    push({V, {}, nullptr, true}, V == R.Call ? nullptr : R.Call);
  if (!R.Target && R.Values.empty())
    push({R.Call, {}, nullptr, true});
  if (R.Target) {
    SmallVector<LoadInst *, 8> Loads = Access.usesOf(*R.Call, R.Target);
    if (Loads.empty())
      end(Access.resolve(R.Target, true).empty() ? ValueEnd::UnknownPointer
                                                 : ValueEnd::Unread,
          R.Call);
    SmallVector<ScalarPart, 1> Written;
    for (Location &L : Access.resolve(R.Target, true))
      Written.push_back({std::move(L)});
    load({R.Call, {}, nullptr, true}, *R.Call, Written, Loads);
  }
  while (std::optional<State> At = next()) {
    const State &S = *At;
    Here = S.Way;
    for (Use &U : S.V->uses())
      useOfValue(S, U, N);
  }
  if (Usage.Comparisons.size() == Before)
    forgetHops(HopsBefore);
}

ParameterUsage Follower::run() {
  for (unsigned N = 0; N < Reads.size(); ++N)
    followRead(N);
  return std::move(Usage);
}

ParameterUsage ParamUsageFinder::run(Module &M, ModuleAnalysisManager &AM) {
  return Follower(M, AM).run();
}

PreservedAnalyses ParamUsageFinderPrinter::run(Module &M,
                                               ModuleAnalysisManager &AM) {
  const ParameterUsage &R = AM.getResult<ParamUsageFinder>(M);
  const auto &Reads = AM.getResult<ParamCallFinder>(M);
  OS << "parameter usage of " << M.getName() << ": " << R.Comparisons.size()
     << " comparisons, " << R.lost() << " lost\n";
  for (const ParameterComparison &C : R.Comparisons) {
    OS << "  '" << Reads[C.Read].Name << "' as " << C.How.text() << ' ';
    const auto *Where = C.Compare                ? cast<Instruction>(C.Compare)
                        : C.TextRelation.empty() ? C.Decisions.front().Predicate
                                                 : cast<Instruction>(C.Flag);
    OS << (C.Compare || !C.TextRelation.empty() ? "compared" : "flag") << " in "
       << Where->getFunction()->getName() << place(*Where);
    for (const Decision &D : C.Decisions)
      OS << (D.Direct ? " decides" : " later decides") << place(*D.Predicate);
    OS << '\n';
  }
  return PreservedAnalyses::all();
}

} // namespace tpc
