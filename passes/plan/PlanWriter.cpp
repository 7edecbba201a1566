//===- PlanWriter.cpp -----------------------------------------------------===//
#include "plan/PlanWriter.h"

#include "output/Describer.h"
#include "plan/Checksum.h"
#include "plan/Manifest.h"
#include "plan/Plan.h"
#include "support/Functions.h"
#include "support/Names.h"
#include "support/Numbers.h"

#include "llvm/ADT/MapVector.h"
#include "llvm/IR/Instructions.h"

using namespace llvm;

namespace tpc {

namespace {

/// Gives functions their numbers, and values theirs.
class Numbering {
public:
  /// \p Copied says which functions of \p M, or of the analysed copy of it,
  /// are copies for single calls.
  Numbering(Module &M, Plan &Out, ArrayRef<std::vector<CopiedFunction>> Copied);

  /// The number of the function \p Name of either module.
  uint64_t function(StringRef Name);
  uint64_t function(const Instruction &I) {
    return function(I.getFunction()->getName());
  }
  uint64_t instruction(const Instruction &I);
  /// \p V in function \p F; a constant as an operand of one of \p Near, if
  /// possible.
  PlannedValue value(const Value &V, const Function &F,
                     ArrayRef<const Value *> Near);

private:
  static std::optional<unsigned> operandOf(const Value *User, const Value &V);

  Module &M;
  Plan &Out;
  StringMap<uint64_t> Functions;
  DenseMap<const Function *, DenseMap<const Instruction *, unsigned>> Numbers;
};

} // namespace

Numbering::Numbering(Module &M, Plan &Out,
                     ArrayRef<std::vector<CopiedFunction>> Copied)
    : M(M), Out(Out) {
  auto Add = [&](PlannedFunction F) {
    Out.Functions.push_back(std::move(F));
    return Out.Functions.size() - 1;
  };
  for (const std::vector<CopiedFunction> &Round : Copied) {
    Out.Rounds.emplace_back();
    for (const CopiedFunction &F : Round) {
      const uint64_t Of = function(F.Name);
      Out.Rounds.back().push_back(Of);
      // Callers are what they were before.
      SmallVector<std::pair<StringRef, uint64_t>, 8> Now;
      for (const CopiedFunction::Call &Call : F.Calls) {
        PlannedFunction Copy;
        Copy.Of = Of;
        Copy.In = function(Call.Caller);
        Copy.At = Call.Number;
        Now.emplace_back(Call.Callee, Add(std::move(Copy)));
      }
      for (auto [Name, Number] : Now)
        Functions[Name] = Number;
    }
  }
}

uint64_t Numbering::function(StringRef Name) {
  auto [It, New] = Functions.try_emplace(Name, Out.Functions.size());
  if (!New)
    return It->second;
  PlannedFunction F;
  F.Name = F.Linkage = Name.str();
  if (const Function *There = M.getFunction(Name)) {
    if (There->hasFnAttribute(LocalOf)) {
      F.Unit = unitOf(*There).str();
      F.Name = nameInUnit(*There).str();
    }
    F.Linkage = sourceNameOf(*There).str();
    F.Checksum = checksumOf(*There);
    if (const DISubprogram *SP = There->getSubprogram()) {
      F.File = pathOf(SP->getFile());
      F.Line = SP->getLine();
    }
  }
  Out.Functions.push_back(std::move(F));
  return Out.Functions.size() - 1;
}

uint64_t Numbering::instruction(const Instruction &I) {
  const Function &F = *I.getFunction();
  auto [It, New] = Numbers.try_emplace(&F);
  if (New)
    for (auto [Number, Each] : enumerate(numberedInstructions(F)))
      It->second[&Each] = Number;
  return It->second.at(&I);
}

std::optional<unsigned> Numbering::operandOf(const Value *Of, const Value &V) {
  if (const auto *I = dyn_cast_or_null<Instruction>(Of))
    for (const Use &U : I->operands())
      if (U.get() == &V)
        return U.getOperandNo();
  return std::nullopt;
}

PlannedValue Numbering::value(const Value &V, const Function &F,
                              ArrayRef<const Value *> Near) {
  PlannedValue Of;
  if (const auto *A = dyn_cast<Argument>(&V)) {
    Of.Argument = A->getArgNo();
    return Of;
  }
  if (const auto *I = dyn_cast<Instruction>(&V)) {
    Of.At = instruction(*I);
    return Of;
  }
  for (const Value *User : Near)
    if ((Of.Operand = operandOf(User, V))) {
      Of.At = instruction(*cast<Instruction>(User));
      return Of;
    }
  for (const Instruction &I : numberedInstructions(F))
    if ((Of.Operand = operandOf(&I, V))) {
      Of.At = instruction(I);
      return Of;
    }
  return Of;
}

namespace {

class Writer {
public:
  Writer(Module &M, AnalysedModule &Analysed, ModuleAnalysisManager &AM,
         const Options &Opts, const Findings &Found, const PlannedFindings &Of)
      : Seen(Analysed.module()), AM(AM), Opts(Opts), Found(Found), Of(Of),
        Reads(AM.getResult<ParamCallFinder>(Seen)),
        Gathered(AM.getResult<GatherResults>(Seen)),
        Described(Seen, AM, this->Opts), Numbers(M, Out, Analysed.copied()) {
    this->Opts.KeepAbsolute = true;
  }

  Plan run();

private:
  PlannedKey keyOf(const Comparison &C) const;
  void addReports();
  void addNames();
  void addComparisons(ArrayRef<SourcePlace> All);
  void addEntries();
  void addPlaces(ListedPlaces Places, std::vector<PlannedEntry> &To);
  void addCounts();

  Module &Seen;
  ModuleAnalysisManager &AM;
  Options Opts;
  const Findings &Found;
  const PlannedFindings &Of;
  const ParamCallFinder::Result &Reads;
  const GatheredResults &Gathered;
  Describer Described;
  Plan Out;
  Numbering Numbers;
};

} // namespace

PlannedKey Writer::keyOf(const Comparison &C) const {
  return {KeyParts::of(*C.Where, whatOf(C, Reads)), C.Ordinal};
}

void Writer::addReports() {
  for (auto [Report, C] : zip_equal(Found.Reports, Of.Reported)) {
    const auto &R = Report;
    const Function &F = *R.Before->getFunction();
    const Value *Near[] = {R.Outcome, R.Held, R.Result, R.Before};
    auto ValueOf = [&](const Value &V) { return Numbers.value(V, F, Near); };
    PlannedReport P;
    P.Function = Numbers.function(F.getName());
    P.Key = keyOf(*C);
    P.Before = Numbers.instruction(*R.Before);
    P.Result = ValueOf(*R.Result);
    P.Compared = ValueOf(*R.Compared);
    P.Threshold = ValueOf(*R.Threshold);
    P.Outcome = ValueOf(*R.Outcome);
    if (R.Object)
      P.Object = ValueOf(*R.Object);
    if (R.Held)
      P.Held = Numbers.instruction(*R.Held);
    P.Switch = R.Switch;
    P.Signed = R.Signed;
    Out.Reports.push_back(std::move(P));
  }
  for (const Comparison *C : Of.WithoutReport)
    Out.WithoutReport.push_back(Numbers.function(C->place()));
}

void Writer::addNames() {
  for (auto [Name, Read] : zip_equal(Found.Names, Of.Named)) {
    const NamedRead &N = Name;
    const Function &F = *N.Before->getFunction();
    auto Some = [&](const Value *V) -> std::optional<PlannedValue> {
      if (!V)
        return std::nullopt;
      return Numbers.value(*V, F, {N.Before});
    };
    PlannedName P;
    P.Function = Numbers.function(F.getName());
    P.Read = Read - Reads.data();
    P.Before = Numbers.instruction(*N.Before);
    P.Offset = N.HandleOffset;
    P.Size = N.ObjectSize;
    P.Handle = Some(N.Handle);
    P.Name = Some(N.Name);
    P.Object = Some(N.Object);
    P.Text = N.Text;
    P.NodeName = N.NodeName;
    P.IsText = N.IsText;
    Out.Names.push_back(std::move(P));
  }
}

void Writer::addComparisons(ArrayRef<SourcePlace> All) {
  DenseMap<const Comparison *, unsigned> Order;
  for (const auto *Kind : {&Gathered.Comparisons, &Gathered.Constants})
    for (const Comparison &C : *Kind)
      Order.try_emplace(&C, Order.size());
  for (const SourcePlace &P : All) {
    SmallVector<const Comparison *, 4> Instances(P.Instances.begin(),
                                                 P.Instances.end());
    sort(Instances, [&](const Comparison *A, const Comparison *B) {
      return Order.lookup(A) < Order.lookup(B);
    });
    MapVector<uint64_t, SourcePlace> ByFunction;
    for (const Comparison *C : Instances) {
      SourcePlace &Here = ByFunction[Numbers.function(C->place())];
      Here.Source = P.Source;
      Here.Instances.push_back(C);
      if (C->Slice.Distance < Here.Instances.front()->Slice.Distance)
        std::swap(Here.Instances.front(), Here.Instances.back());
    }
    for (auto &[Function, Here] : ByFunction) {
      PlannedComparison C;
      C.Function = Function;
      C.Key = keyOf(*Here.Instances.front());
      C.Info = Described.comparison(Here);
      C.Info.erase("key");
      for (const Comparison *Each : Here.Instances)
        C.Instances.push_back({Order.lookup(Each),
                               Each->Slice.Distance,
                               Described.loopDepth(*Each),
                               {Each->Reads.begin(), Each->Reads.end()}});
      Out.Comparisons.push_back(std::move(C));
    }
  }
}

static json::Object takeObject(json::Value &V) {
  return std::move(*V.getAsObject());
}

void Writer::addEntries() {
  json::Array Parameters = Described.parameters();
  for (auto [Info, Read] : zip_equal(Parameters, Reads)) {
    PlannedEntry E{Numbers.function(*Read.Call), std::nullopt,
                   takeObject(Info)};
    if (E.Info.erase("key"))
      E.Key = {KeyParts::of(*Read.Call->getDebugLoc(), Read.Name), 0};
    Out.Parameters.push_back(std::move(E));
  }
  json::Array Exposing = Described.exposing();
  for (auto [Info, E] :
       zip_equal(Exposing, AM.getResult<ExternCallFinder>(Seen)))
    Out.Exposing.push_back(
        {Numbers.function(*E.At), std::nullopt, takeObject(Info)});
}

void Writer::addPlaces(ListedPlaces Places, std::vector<PlannedEntry> &To) {
  for (auto [Info, In] : zip_equal(Places.List, Places.In))
    To.push_back(
        {Numbers.function(In->getName()), std::nullopt, takeObject(Info)});
}

void Writer::addCounts() {
  MapVector<const Function *, FunctionCounts> Rows;
  for (const Function &F : definedFunctions(Seen)) {
    Rows[&F].Function = Numbers.function(F.getName());
    Rows[&F].Of[FunctionCounts::Defined] = 1;
  }
  auto Count = [&](const Instruction &I, unsigned What) {
    FunctionCounts &Row = Rows[I.getFunction()];
    Row.Function = Numbers.function(I);
    ++Row.Of[What];
  };
  for (const Instruction *P : AM.getResult<IfStatements>(Seen).predicates())
    Count(*P, FunctionCounts::Predicates);
  DenseMap<const Function *, uint64_t> InSlice;
  for (const Instruction *P :
       AM.getResult<BackwardPropagate>(Seen).predicates())
    ++InSlice[P->getFunction()];
  for (const Function &F : Seen)
    if (uint64_t Number = InSlice.lookup(&F)) {
      Rows[&F].Function = Numbers.function(F.getName());
      Rows[&F].Of[FunctionCounts::InSlice] = Number;
    }
  for (const CallBase *Call : AM.getResult<SimpleCallGraph>(Seen).unresolved())
    Count(*Call, FunctionCounts::IndirectCalls);
  for (const ValueEnd &E : AM.getResult<ParamUsageFinder>(Seen).Ends)
    if (E.isLost())
      Count(*E.At, FunctionCounts::Lost);
  for (const NotReported &N : Gathered.Others)
    if (N.Why == NotReported::WithoutDebugInfo ||
        N.Why == NotReported::OutsideSources)
      Count(N.Compared->place(), N.Why == NotReported::OutsideSources
                                     ? FunctionCounts::Outside
                                     : FunctionCounts::NoDebugInfo);
  for (auto &[F, Row] : Rows)
    Out.Counts.push_back(Row);
}

Plan Writer::run() {
  Out.Process = Opts.LinkUnit;
  Out.Incomplete = Found.Incomplete;
  Out.Separated = Found.IsChanged;
  Out.Nodes = Found.Nodes;
  Out.GivenUp = AM.getResult<VisibleWritesAnalysis>(Seen).givenUp();
  addReports();
  addNames();
  std::vector<SourcePlace> All = Described.comparisons();
  addComparisons(All);
  addEntries();
  addPlaces(Described.explain().notExposed(All, /*Every=*/true),
            Out.NotExposed);
  addPlaces(Described.explain().blindSpots(/*Every=*/true), Out.BlindSpots);
  addCounts();
  return std::move(Out);
}

void writePlan(Module &M, AnalysedModule &Analysed, ModuleAnalysisManager &AM,
               const Options &Opts, const Findings &Found,
               const PlannedFindings &Of) {
  Plan Written = Writer(M, Analysed, AM, Opts, Found, Of).run();
  if (Error E = writeJsonText(toJSON(Written), Opts.PlanOut))
    warn(Opts, "cannot write the plan: " + toString(std::move(E)));
}

} // namespace tpc
