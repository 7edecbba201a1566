//===- ApplyPlans.cpp -----------------------------------------------------===//
#include "plan/ApplyPlans.h"

#include "Rules.h"
#include "plan/PlanDescriber.h"
#include "support/Numbers.h"

#include "llvm/ADT/StringSet.h"

#include <map>

using namespace llvm;

namespace tpc {

namespace {

/// The values of a module as plans name them.
class Values {
public:
  Instruction *instruction(Function &F, uint64_t Number) {
    auto [It, New] = Known.try_emplace(&F);
    if (New)
      for (Instruction &I : numberedInstructions(F))
        It->second.push_back(&I);
    return Number < It->second.size() ? It->second[Number] : nullptr;
  }
  /// Null if there is none, or it has no value.
  Value *value(Function &F, const PlannedValue &Of) {
    if (Of.Argument)
      return *Of.Argument < F.arg_size() ? F.getArg(*Of.Argument) : nullptr;
    Instruction *I = instruction(F, *Of.At);
    if (!I || !Of.Operand)
      return I && !I->getType()->isVoidTy() ? I : nullptr;
    return *Of.Operand < I->getNumOperands() ? I->getOperand(*Of.Operand)
                                             : nullptr;
  }

private:
  DenseMap<Function *, std::vector<Instruction *>> Known;
};

class Applier {
public:
  Applier(Module &M, const Rules &Tables, const Options &Opts, Findings &Out)
      : M(M), Tables(Tables), Opts(Opts), Out(Out) {}
  void run();

private:
  bool read();
  void place();
  bool mayReport(const Plan &Of, const DefinedFunctions &Defined) const;
  void addReports(const PlacedPlan &P);
  void addReport(const PlannedReport &Planned, Function &F);
  std::optional<Report> reportOf(const PlannedReport &Planned, Function &F);
  void addNames(const PlacedPlan &P);
  std::optional<NamedRead> nameOf(const PlannedName &Planned, Function &F);
  void warnOfDifferences(const PlacedPlan &P);

  /// What a report is about.
  struct Subject {
    const Value *Outcome, *Compared, *Threshold;
    const Instruction *Before; ///< of a flag alone
    bool operator<(const Subject &O) const {
      return std::tie(Outcome, Compared, Threshold, Before) <
             std::tie(O.Outcome, O.Compared, O.Threshold, O.Before);
    }
  };

  Module &M;
  const Rules &Tables;
  const Options &Opts;
  Findings &Out;
  std::vector<std::unique_ptr<PlacedPlan>> Plans;
  Values Here;
  /// The numbers of the reports of earlier plans, by subject and key. One plan
  /// may have several, as an analysis may.
  std::map<std::pair<Subject, std::string>, size_t> Known;
  /// The numbers of all reports, by subject, place and key.
  std::map<std::pair<Subject, std::string>, size_t> Placed;
  size_t Earlier = 0; ///< reports of earlier plans
};

} // namespace

/// Reads the plans; false if none can be used.
bool Applier::read() {
  for (const std::string &File : Opts.Plans) {
    Expected<Plan> Read = readPlan(File);
    if (!Read) {
      std::string Why = toString(Read.takeError());
      std::replace(Why.begin(), Why.end(), '\n', ' ');
      warn(Opts, "cannot use a plan: " + Why);
      continue;
    }
    Plans.push_back(std::make_unique<PlacedPlan>());
    Plans.back()->Of = std::move(*Read);
  }
  return !Plans.empty();
}

/// True if something that \p Of compares may be in the link unit.
bool Applier::mayReport(const Plan &Of, const DefinedFunctions &Defined) const {
  return any_of(Of.Comparisons, [&](const PlannedComparison &C) {
    return !Defined.candidates(Of.base(C.Function)).empty();
  });
}

/// Finds the functions of all plans. Functions are inlined and copied as in the
/// analysed program.
void Applier::place() {
  const std::string Unit = Opts.fullName();
  DefinedFunctions Before(M, Unit);
  SmallVector<PlacedPlan *, 4> Separated;
  for (const auto &P : Plans)
    if (P->Of.Separated && mayReport(P->Of, Before))
      Separated.push_back(P.get());
    else
      P->Functions.emplace(M, P->Of, Before);
  if (Separated.empty())
    return;
  Out.IsChanged = true;
  Separation(Tables).applyTo(M);
  DefinedFunctions After(M, Unit);
  for (PlacedPlan *P : Separated) {
    P->Functions.emplace(M, P->Of, After);
    P->Functions->separate();
    for (const auto &Other : Plans)
      if (Other.get() != P && Other->Functions)
        Other->Functions->addCopies(*P->Functions);
  }
}

std::optional<Report> Applier::reportOf(const PlannedReport &Planned,
                                        Function &F) {
  Report R;
  R.Key = comparisonKey(nameOfComparison(Planned.Key.Parts, Opts),
                        Planned.Key.Ordinal);
  R.Before = Here.instruction(F, Planned.Before);
  R.Result = Here.value(F, Planned.Result);
  R.Compared = Here.value(F, Planned.Compared);
  R.Threshold = Here.value(F, Planned.Threshold);
  R.Outcome = Here.value(F, Planned.Outcome);
  R.Signed = Planned.Signed;
  if (!R.Before || !R.Result || !R.Compared || !R.Threshold || !R.Outcome)
    return std::nullopt;
  if (Planned.Object && !(R.Object = Here.value(F, *Planned.Object)))
    return std::nullopt;
  if (Planned.Switch && !(R.Switch = dyn_cast<SwitchInst>(R.Before)))
    return std::nullopt;
  if (Planned.Held) {
    R.Held = dyn_cast_or_null<CallBase>(Here.instruction(F, *Planned.Held));
    const Function *Callee = R.Held ? R.Held->getCalledFunction() : nullptr;
    R.HeldRow = Callee ? Tables.match(*Callee).Row : nullptr;
    if (!R.HeldRow || R.HeldRow->Kind != Rule::Held)
      return std::nullopt;
  }
  return R;
}

namespace {

/// The calls from outside of the unit enter one function, which can report only
/// what is the same for all of them.
class Ambiguity {
public:
  explicit Ambiguity(const PlacedPlan &P) : P(P) {}
  /// \p At, a report or name, is about \p Value, and that is \p What.
  template <typename T>
  void add(const T &At, const PlannedValue &Value, StringRef What) {
    if (P.Functions->isForOthers(At.Function))
      All[placeOf(At, Value)].insert(What);
  }
  template <typename T> bool has(const T &At, const PlannedValue &Value) const {
    if (!P.Functions->isForOthers(At.Function))
      return false;
    auto Known = All.find(placeOf(At, Value));
    return Known != All.end() && Known->second.size() > 1;
  }

private:
  using Number = std::optional<uint64_t>;
  using Place = std::tuple<uint64_t, uint64_t, Number, Number, Number>;
  template <typename T>
  Place placeOf(const T &At, const PlannedValue &Value) const {
    return {P.Of.baseNumber(At.Function), At.Before, Value.Argument, Value.At,
            Value.Operand};
  }

  const PlacedPlan &P;
  std::map<Place, StringSet<>> All;
};

} // namespace

void Applier::addReport(const PlannedReport &Planned, Function &F) {
  std::optional<Report> R = reportOf(Planned, F);
  if (!R) {
    ++Out.NotInstrumented;
    return;
  }
  auto Of = [&](const Instruction *Before) {
    return std::pair(Subject{R->Outcome, R->Compared, R->Threshold, Before},
                     R->Key);
  };
  // The copies that a plan has for calls from other units are one function
  // here, and an evaluation in it is one report.
  if (auto Same = Placed.find(Of(R->Before)); Same != Placed.end()) {
    if (Report &There = Out.Reports[Same->second]; !There.Object)
      There.Object = R->Object;
    return;
  }
  // A flag may be the condition of several predicates.
  const size_t Number = Out.Reports.size();
  auto [It, New] = Known.try_emplace(
      Of(R->Compared == R->Threshold ? R->Before : nullptr), Number);
  if (!New && It->second < Earlier)
    return;
  Placed.try_emplace(Of(R->Before), Number);
  Out.Reports.push_back(std::move(*R));
}

void Applier::addReports(const PlacedPlan &P) {
  Earlier = Out.Reports.size();
  Ambiguity Others(P);
  for (const PlannedReport &R : P.Of.Reports)
    Others.add(R, R.Threshold, R.Key.Parts.What);
  for (const PlannedReport &R : P.Of.Reports) {
    const PlanFunctions::Set &In = P.Functions->of(R.Function);
    if (P.Functions->isHere(R.Function) &&
        (In.empty() || Others.has(R, R.Threshold)))
      ++Out.NotInstrumented;
    else
      for (Function *F : In)
        addReport(R, *F);
  }
  for (uint64_t Number : P.Of.WithoutReport)
    Out.NotInstrumented += P.Functions->isHere(Number);
}

std::optional<NamedRead> Applier::nameOf(const PlannedName &Planned,
                                         Function &F) {
  auto *Before =
      dyn_cast_or_null<CallBase>(Here.instruction(F, Planned.Before));
  if (!Before)
    return std::nullopt;
  NamedRead N{"",      Before,       nullptr,       Planned.Offset,
              nullptr, Planned.Text, Planned.IsText};
  N.ObjectSize = Planned.Size;
  N.NodeName = Planned.NodeName;
  auto Set = [&](Value *&To, const std::optional<PlannedValue> &Of) {
    if (Of)
      To = Here.value(F, *Of);
    return !Of || (To && To->getType()->isPointerTy());
  };
  if (!Set(N.Handle, Planned.Handle) || !Set(N.Name, Planned.Name) ||
      !Set(N.Object, Planned.Object))
    return std::nullopt;
  return N;
}

void Applier::addNames(const PlacedPlan &P) {
  const size_t OfEarlier = Out.Names.size();
  auto KeyOf = [&](const PlannedName &Planned) -> const auto & {
    return P.Of.Parameters[Planned.Read].Key;
  };
  Ambiguity Others(P);
  for (const PlannedName &Planned : P.Of.Names)
    if (KeyOf(Planned))
      Others.add(Planned, {}, KeyOf(Planned)->Parts.What);
  for (const PlannedName &Planned : P.Of.Names) {
    const std::optional<PlannedKey> &Key = KeyOf(Planned);
    // Of a list, all have one place.
    if (!Key || (Planned.Text.empty() && Others.has(Planned, {})))
      continue;
    for (Function *F : P.Functions->of(Planned.Function)) {
      std::optional<NamedRead> N = nameOf(Planned, *F);
      if (!N)
        continue;
      N->Key = readKey(Key->Parts, Opts);
      if (none_of(ArrayRef(Out.Names).take_front(OfEarlier),
                  [&](const NamedRead &O) {
                    return O.Before == N->Before && O.Key == N->Key &&
                           O.Text == N->Text;
                  }))
        Out.Names.push_back(std::move(*N));
    }
  }
}

/// Says how many reports of \p P are left out because the functions here are
/// others.
void Applier::warnOfDifferences(const PlacedPlan &P) {
  DenseSet<uint64_t> Functions;
  unsigned Reports = 0;
  for (const PlannedReport &R : P.Of.Reports)
    if (P.Functions->differs(R.Function)) {
      Functions.insert(P.Of.baseNumber(R.Function));
      ++Reports;
    }
  Out.NotInstrumented += Reports;
  if (Reports)
    warn(Opts, "the plan of " + P.Of.Process + " is about other code: " +
                   Twine(Functions.size()) + " functions differ, and " +
                   Twine(Reports) + " reports are left out");
}

void Applier::run() {
  if (!read()) {
    Out.Failure = "no plan can be used";
    return;
  }
  place();
  for (const auto &P : Plans) {
    warnOfDifferences(*P);
    Out.Nodes |= P->Of.Nodes;
    if (Out.Incomplete.empty())
      Out.Incomplete = P->Of.Incomplete;
    if (!Opts.Instrument)
      continue;
    addReports(*P);
    addNames(*P);
  }
  Out.Unit = describePlanned(Plans, Opts);
}

void applyPlans(Module &M, const Rules &Tables, const Options &Opts,
                Findings &Out) {
  Applier(M, Tables, Opts, Out).run();
}

} // namespace tpc
