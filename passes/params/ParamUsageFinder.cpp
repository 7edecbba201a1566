//===- ParamUsageFinder.cpp -----------------------------------------------===//
#include "params/ParamUsageFinder.h"

#include "calls/SimpleCallGraph.h"
#include "control/IfStatements.h"
#include "params/Follower.h"
#include "params/Idioms.h"
#include "params/ObjectsOfCalls.h"
#include "params/ParamCallFinder.h"
#include "params/ParameterObjects.h"
#include "params/Registers.h"
#include "params/TextUsage.h"
#include "support/Names.h"
#include "support/Print.h"

#include "llvm/ADT/SmallPtrSet.h"
#include "llvm/IR/IntrinsicInst.h"
#include "llvm/IR/Module.h"

using namespace llvm;

namespace tpc {

AnalysisKey ParamUsageFinder::Key;

static constexpr double NanosecondsPerSecond = 1e9;

unsigned ParameterUsage::lost() const {
  return count_if(Ends, [](const ValueEnd &E) { return E.isLost(); });
}

SmallVector<Hop, 16> ParameterUsage::pathTo(unsigned Last) const {
  SmallVector<Hop, 16> Path;
  for (unsigned N = Last; N != Hop::None; N = Hops[N].From)
    Path.push_back(Hops[N]);
  std::reverse(Path.begin(), Path.end());
  return Path;
}

StringRef relationOf(CmpInst::Predicate P) {
  switch (P) {
  case CmpInst::ICMP_EQ:
  case CmpInst::FCMP_OEQ:
  case CmpInst::FCMP_UEQ:
    return "==";
  case CmpInst::ICMP_NE:
  case CmpInst::FCMP_ONE:
  case CmpInst::FCMP_UNE:
    return "!=";
  case CmpInst::ICMP_SGT:
  case CmpInst::ICMP_UGT:
  case CmpInst::FCMP_OGT:
  case CmpInst::FCMP_UGT:
    return ">";
  case CmpInst::ICMP_SGE:
  case CmpInst::ICMP_UGE:
  case CmpInst::FCMP_OGE:
  case CmpInst::FCMP_UGE:
    return ">=";
  case CmpInst::ICMP_SLT:
  case CmpInst::ICMP_ULT:
  case CmpInst::FCMP_OLT:
  case CmpInst::FCMP_ULT:
    return "<";
  case CmpInst::ICMP_SLE:
  case CmpInst::ICMP_ULE:
  case CmpInst::FCMP_OLE:
  case CmpInst::FCMP_ULE:
    return "<=";
  default:
    return "";
  }
}

bool comparesValues(const CmpInst &Compare) {
  return !relationOf(Compare.getPredicate()).empty();
}

/// True for operations that combine two truth values into one.
static bool isLogical(const Instruction &I) {
  return I.getOpcode() == Instruction::And ||
         I.getOpcode() == Instruction::Or || I.getOpcode() == Instruction::Xor;
}

/// True if \p I decides by \p U.
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
  while (std::optional<State> At = takeNext()) {
    const State &S = *At;
    Here = S.Way;
    for (Use &U : S.V->uses()) {
      auto *I = dyn_cast<Instruction>(U.getUser());
      if (!I)
        continue;
      if (!S.In && decidesBy(*I, U)) {
        Found.push_back({I, S.Direct, S.Way});
        continue;
      }
      if (followRepacked(S, U))
        continue;
      if (!S.In && (isLogical(*I) || isa<ICmpInst>(I)))
        push({I, {}, S.Path, S.Direct});
      else if (!carry(S, U))
        stopAt(ValueEnd::Outcome, I);
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

/// True if \p Compare, of which one operand is computed as \p How says, has no
/// threshold: a formula is compared with a constant, or with a value that is in
/// the formula. A remainder that is equal to a constant says how often
/// something is done.
static bool hasNoThreshold(const CmpInst &Compare, unsigned Operand,
                           const Transform &How) {
  if (!How.Variables)
    return false;
  const Value *Other = Compare.getOperand(1 - Operand);
  if (const auto *C = dyn_cast<Constant>(Other))
    return !(How.isDifference() && C->isZeroValue()) &&
           !(How.isRemainder() && Compare.isEquality());
  return isComputedFrom(Compare.getOperand(Operand), Other);
}

/// True if \p Compared, a value in \p F that \p S has led to, is not the
/// parameter in every call of \p F: it came by an argument, or is loaded from
/// an object that is an argument.
bool Follower::holdsInOneCall(const State &S, const Value *Compared,
                              const Function &F) const {
  ArrayRef<CallBase *> Callers = Calls.callers(&F);
  return Callers.size() > 1 &&
         (S.Path || isLoadedForOneCall(Compared, Callers, Pointers));
}

/// Adds a flag: \p V, computed from what \p S follows, decides \p D by itself.
void Follower::addFlag(const State &S, Value *V, Decision D, unsigned Read,
                       bool IsOperand) {
  ParameterComparison C;
  // An argument has no place of its own, so the flag is placed at the branch.
  C.IsOperand = IsOperand && isa<Instruction>(V);
  C.How = S.How;
  C.ByArgument = holdsInOneCall(S, V, *D.Predicate->getFunction());
  C.Read = Read;
  C.Flag = V;
  C.Decisions.push_back(D);
  Usage.Comparisons.push_back(std::move(C));
}

/// True if \p I is the value that `&&` or `||` computes from its last operand
/// \p U: all other paths to it are already decided.
static bool isShortCircuit(const Instruction &I, const Use &U) {
  const auto *Phi = dyn_cast<PHINode>(&I);
  return Phi && Phi->getType()->isIntegerTy(1) &&
         Phi->getNumIncomingValues() > 1 &&
         all_of(Phi->incoming_values(),
                [&](const Use &In) { return &In == &U || isa<Constant>(In); });
}

/// True if \p Compare only asks whether an operand is not zero, as C++ does if
/// a number is used as a condition.
static bool asksForNonZero(const CmpInst &Compare, unsigned Operand) {
  const auto *Zero = dyn_cast<Constant>(Compare.getOperand(1 - Operand));
  return Zero && Zero->isZeroValue() &&
         (Compare.getPredicate() == CmpInst::ICMP_NE ||
          Compare.getPredicate() == CmpInst::FCMP_UNE);
}

void Follower::addComparison(const State &S, CmpInst &Compare, unsigned Operand,
                             unsigned Read) {
  if (Compare.getOperand(0) == Compare.getOperand(1) ||
      Compare.getOperand(0)->getType()->isPtrOrPtrVectorTy())
    return;
  if (!comparesValues(Compare) || hasNoThreshold(Compare, Operand, S.How))
    return stopAt(ValueEnd::Mixed, &Compare);
  if (S.How.kind() == Transform::None && asksForNonZero(Compare, Operand)) {
    for (const Decision &D : followOutcome(&Compare, S.Path))
      addFlag(S, &Compare, D, Read, /*IsOperand=*/!D.Direct);
    return;
  }
  ParameterComparison C;
  C.Read = Read;
  C.Compare = &Compare;
  C.Operand = Operand;
  C.How = S.How;
  C.ByArgument =
      holdsInOneCall(S, Compare.getOperand(Operand), *Compare.getFunction());
  C.Decisions = followOutcome(&Compare, S.Path);
  Usage.Comparisons.push_back(std::move(C));
}

/// Adds \p Predicate, which the value itself decides.
void Follower::addDecision(const State &S, Instruction &Predicate,
                           unsigned Read) {
  if (S.How.kind() == Transform::None ||
      (isa<SwitchInst>(Predicate) && !S.How.Variables))
    addFlag(S, S.Origin ? S.Origin : S.V, {&Predicate, !S.Origin, S.Way}, Read,
            /*IsOperand=*/S.Origin != nullptr);
}

/// For a merged value that was already followed from another of its origins,
/// only what it decides is added.
void Follower::followUseOfMerged(const State &S, Use &U, unsigned Read) {
  auto *I = dyn_cast<Instruction>(U.getUser());
  if (!I || S.In)
    return;
  if (decidesBy(*I, U))
    addDecision(S, *I, Read);
  else if (const auto *Cast = dyn_cast<CastInst>(I))
    push({I, applyCast(S.How, *Cast), S.Path, S.Direct, S.In, S.Origin});
  else if ((isa<PHINode>(I) && !isShortCircuit(*I, U)) || isa<SelectInst>(I) ||
           isa<FreezeInst>(I))
    carry(S, U);
}

/// If \p I puts the value of \p S into an object that holds a number, follows
/// it to where it is taken out again; false if it does not.
bool Follower::followHeld(const State &S, Instruction &I) {
  auto *Call = dyn_cast<CallBase>(&I);
  const Rule *Row = Call ? Rules.match(*Call) : nullptr;
  if (!Row || Row->Kind != Rule::Held || Row->Relation != "into")
    return false;
  const Value *Number = argument(*Call, *Row, Row->Value),
              *Rest = argument(*Call, *Row, Row->Rest);
  if (Number != S.V && Rest != S.V)
    return false;
  const bool IsRest = Number != S.V;
  const Value *Other = IsRest ? Number : Rest;
  std::optional<double> Constant = 0;
  if (Other)
    Constant = constantNumber(Other);
  // Nanoseconds beside seconds that are not known say nothing about the whole;
  // seconds do.
  if (IsRest && !Constant) {
    stopAt(ValueEnd::Mixed, &I);
    return true;
  }
  Transform How = withoutNarrowing(S.How);
  How.divide(IsRest ? NanosecondsPerSecond : Row->PerSecond);
  How.add(Constant.value_or(0) /
          (IsRest ? Row->PerSecond : NanosecondsPerSecond));
  for (CallBase *Out : Texts.numbersFrom(*Call, *Row)) {
    Transform Taken = How;
    if (const Rule *Taking = Rules.match(*Out))
      Taken.multiply(Taking->PerSecond);
    push({Out, Taken, nullptr, false}, Call);
  }
  return true;
}

void Follower::followUse(const State &S, Use &U, unsigned Read) {
  auto *I = dyn_cast<Instruction>(U.getUser());
  if (!I)
    return;
  if (S.IsAnotherOrigin)
    return followUseOfMerged(S, U, Read);
  if (followRepacked(S, U))
    return;
  if (S.In) {
    if (!carry(S, U))
      stopAt(ValueEnd::Mixed, I);
    return;
  }
  if (auto *Compare = dyn_cast<CmpInst>(I))
    return addComparison(S, *Compare, U.getOperandNo(), Read);
  if (decidesBy(*I, U))
    return addDecision(S, *I, Read);
  if (isLogical(*I) && S.V->getType()->isIntegerTy(1)) {
    for (Decision D : followOutcome(I, S.Path))
      addFlag(S, S.V, D, Read, /*IsOperand=*/!D.Direct);
    return;
  }
  if (isShortCircuit(*I, U) && S.How.kind() == Transform::None &&
      isa<Instruction>(S.V)) {
    for (Decision D : followOutcome(I, S.Path))
      addFlag(S, S.V, {D.Predicate, false, D.Way}, Read, /*IsOperand=*/true);
    return;
  }
  if (const auto *Cast = dyn_cast<CastInst>(I))
    return push({I, applyCast(S.How, *Cast), S.Path, S.Direct, S.In, S.Origin});
  if (choiceOf(*I))
    return push({I, throughChoice(S.How, *I), S.Path, S.Direct});
  if (isa<PHINode, SelectInst>(I) &&
      limitsVariable(*I, [&](const Value *Side) { return Side == U.get(); }))
    return;
  if (followHeld(S, *I))
    return;
  if (carry(S, U))
    return;
  auto Name = [&](const Value *V) { return Names.nameOf(V, Pointers); };
  std::optional<Transform> T = apply(S.How, *I, S.V, squareOf(*I), Name);
  if (T && T->Variables > S.How.Variables)
    T->Measured |= any_of(I->operands(), [&](const Use &Other) {
      return Other.get() != S.V && !isa<Function>(Other) &&
             !Configuration.has(Other);
    });
  bool Accumulates =
      T && T->Variables && any_of(I->operands(), [&](const Use &Other) {
        return Other.get() != S.V && isComputedFrom(Other, I);
      });
  if (T && !Accumulates)
    push({I, std::move(*T), S.Path, S.Direct});
  else if (!isa<IntrinsicInst>(I) || !I->getType()->isVoidTy())
    stopAt(ValueEnd::Mixed, I);
}

/// Drops those of the comparisons from \p From on whose value was combined with
/// other variables, if the other side has the same parameter in it: it cancels
/// out, or moves both.
void Follower::dropOwnSides(size_t From) {
  auto All = drop_begin(Usage.Comparisons, From);
  SmallPtrSet<const CmpInst *, 8> Sides[2];
  for (const ParameterComparison &C : All)
    if (C.Compare)
      Sides[C.Operand].insert(C.Compare);
  Usage.Comparisons.erase(remove_if(All,
                                    [&](const ParameterComparison &C) {
                                      return C.Compare && C.How.Variables &&
                                             Sides[1 - C.Operand].contains(
                                                 C.Compare);
                                    }),
                          Usage.Comparisons.end());
}

/// True for types whose values are compared as numbers.
static bool isNumber(StringRef Type) {
  static constexpr StringRef Numbers[] = {
      "bool",  "char",           "signed char", "unsigned char",
      "short", "unsigned short", "int",         "unsigned int",
      "long",  "unsigned long",  "long long",   "unsigned long long",
      "float", "double",         "long double"};
  return is_contained(Numbers, Type);
}

/// The object that \p Read makes; null if there is none.
static const Value *madeBy(const ParameterRead &Read) {
  if (Read.Target || !Read.Call->hasStructRetAttr())
    return Read.Target;
  return Read.Call->getArgOperand(0);
}

/// Adds the comparisons of the texts at \p Objects, which a list contains if
/// \p How says so.
void Follower::addTexts(unsigned N, const Locations &Objects,
                        const Transform &How) {
  const ParameterRead &Read = Reads[N];
  TextUsage::Found Found =
      Texts.comparisonsOf(Objects, /*IsList=*/!How.Part.empty());
  for (unsigned Lost = 0; Lost < Found.Lost; ++Lost)
    stopAt(ValueEnd::Mixed, Read.Call);
  for (const TextComparison &T : Found.Comparisons) {
    ParameterComparison C;
    C.Read = N;
    C.Flag = T.Outcome;
    C.TextRelation = T.Relation;
    C.How = How;
    ArrayRef<CallBase *> Callers = Calls.callers(T.Outcome->getFunction());
    C.ByArgument =
        Callers.size() > 1 &&
        (isa<Argument>(T.Text) || isOfOneCall(T.Text, Callers, Pointers));
    C.Decisions = followOutcome(T.Outcome, nullptr);
    Usage.Comparisons.push_back(std::move(C));
  }
}

/// Follows text as an object: the calls that get it compare or copy it.
void Follower::followText(unsigned N) {
  const ParameterRead &Read = Reads[N];
  Locations Objects;
  for (const Value *Field : Read.Values)
    append_range(Objects, Pointers.handed(Field, /*IsOne=*/true));
  if (const Value *Object = Read.Values.empty() ? madeBy(Read) : nullptr)
    Objects = Pointers.handed(Object, /*IsOne=*/true);
  else if (Read.Values.empty())
    return stopAt(ValueEnd::NoNumber, Read.Call);
  Seen.clear();
  addTexts(N, Objects, {});
}

/// A list or struct: its elements are followed, of which each may be the value
/// that is compared, and what the program asks about the list itself.
void Follower::followList(unsigned N) {
  const ParameterRead &Read = Reads[N];
  SmallVector<const Value *, 2> Lists(Read.Values.begin(), Read.Values.end());
  if (const Value *Made = Lists.empty() ? madeBy(Read) : nullptr)
    Lists.push_back(Made);
  Locations Elements;
  for (const Value *List : Lists)
    Pointers.addElements(List, Elements);
  if (Elements.empty())
    return stopAt(ValueEnd::NoNumber, Read.Call);
  size_t Before = Usage.Comparisons.size(), HopsBefore = Usage.Hops.size();
  Transform How;
  How.Part = "element";
  Seen.clear();
  SeenOrigins.clear();
  // Nothing but the read fills an object that a method takes out of it.
  const Instruction *Filled = Read.Values.empty() ? Read.Call : nullptr;
  auto IsElement = [&](const Value *Side) {
    return any_of(Pointers.resolve(Side, true), [&](const Location &L) {
      return any_of(Elements, [&](const Location &E) { return E.mayBe(L); });
    });
  };
  for (LoadInst *Load : Writes.elementsFrom(Filled, Elements))
    if (!limitsVariable(*Load, IsElement))
      push({Load, How, nullptr, true}, Read.Call);
  for (const TextUsage::Property *P : Texts.propertiesOf(Elements)) {
    How.Part = P->Row->Relation;
    for (Value *V : valuesOf(*P->Call))
      push({V, How, nullptr, true}, Read.Call);
  }
  bool IsUnread = Usage.Hops.size() == HopsBefore;
  followAll(N);
  How.Part = "element";
  Seen.clear();
  // The list itself can be compared with a text.
  for (const Value *List : Lists)
    append_range(Elements, Pointers.handed(List, /*IsOne=*/true));
  addTexts(N, Elements, How);
  if (Usage.Comparisons.size() != Before)
    return;
  forgetHops(HopsBefore);
  if (IsUnread)
    stopAt(ValueEnd::Unread, Read.Call);
}

/// Follows the values that were pushed to where they are compared.
void Follower::followAll(unsigned N) {
  size_t Before = Usage.Comparisons.size();
  while (std::optional<State> At = takeNext()) {
    const State &S = *At;
    Here = S.Way;
    for (Use &U : S.V->uses())
      followUse(S, U, N);
  }
  dropOwnSides(Before);
}

void Follower::followRead(unsigned N) {
  const ParameterRead &R = Reads[N];
  ReadAtHand = N;
  size_t HopsBefore = Usage.Hops.size(), Before = Usage.Comparisons.size();
  Here = Hop::None;
  if (isText(R.Type))
    return followText(N);
  if (Rules.isContainer(plainType(R.Type)))
    return followList(N);
  if (!isNumber(R.Type))
    return stopAt(ValueEnd::NoNumber, R.Call);
  Seen.clear();
  SeenOrigins.clear();
  for (Value *V : R.Values)
    push({V, {}, nullptr, true}, V == R.Call ? nullptr : R.Call);
  if (!R.Target && R.Values.empty())
    push({R.Call, {}, nullptr, true});
  if (R.Target) {
    SmallVector<LoadInst *, 8> Loads = Writes.usesOf(*R.Call, R.Target);
    SmallVector<ScalarPart, 1> Written;
    for (Location &L : Pointers.resolve(R.Target, true))
      Written.push_back({std::move(L)});
    if (Loads.empty())
      stopAt(Written.empty() ? ValueEnd::UnknownPointer
                             : endWithoutLoad(Written),
             R.Call);
    load({R.Call, {}, nullptr, true}, *R.Call, Written, Loads);
  }
  followAll(N);
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
