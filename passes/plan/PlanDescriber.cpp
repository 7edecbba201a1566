//===- PlanDescriber.cpp --------------------------------------------------===//
#include "plan/PlanDescriber.h"

#include "output/ExplainInfo.h"
#include "params/Texts.h"
#include "results/BlindSpots.h"

#include "llvm/ADT/MapVector.h"
#include "llvm/ADT/StringSet.h"
#include "llvm/Support/FormatVariadic.h"

#include <map>
#include <set>

using namespace llvm;

namespace tpc {

/// Makes every `file` in \p V relative to the source root.
static void makeRelative(json::Value &V, const Options &Opts) {
  if (json::Array *List = V.getAsArray()) {
    for (json::Value &Each : *List)
      makeRelative(Each, Opts);
  } else if (json::Object *O = V.getAsObject()) {
    for (auto &[Name, Field] : *O)
      if (std::optional<StringRef> Path = Field.getAsString()) {
        if (StringRef(Name) == "file")
          Field = Opts.relative(*Path);
      } else {
        makeRelative(Field, Opts);
      }
  }
}

static json::Object relative(const json::Object &Info, const Options &Opts) {
  json::Value V = json::Object(Info);
  makeRelative(V, Opts);
  return std::move(*V.getAsObject());
}

static std::string textOf(const json::Object &O, StringRef Name) {
  return O.getString(Name).value_or("").str();
}

/// Where an entry is: file, line and column.
using EntryPlace = std::tuple<std::string, int64_t, int64_t>;

static EntryPlace placeOf(const json::Object &O) {
  return {textOf(O, "file"), O.getInteger("lineno").value_or(0),
          O.getInteger("column").value_or(0)};
}

namespace {

/// A comparison that one or several plans have.
struct Merged {
  json::Object Info;
  uint64_t Distance = ~0ULL; ///< of the instance that Info is about
  uint64_t LoopDepth = 0;
  json::Array Reads, Processes;
};

class UnitDescriber {
public:
  UnitDescriber(ArrayRef<std::unique_ptr<PlacedPlan>> Plans,
                const Options &Opts)
      : Plans(Plans), Opts(Opts) {}
  UnitInfo run();

private:
  void mergeComparisons(const PlacedPlan &P);
  void merge(Merged &To, ArrayRef<const PlannedComparison *> Alike,
             const Plan &Of);
  void sortComparisons();
  json::Array entries(std::vector<PlannedEntry> Plan::*List);
  ListedPlaces places(std::vector<PlannedEntry> Plan::*List, StringRef Name);
  json::Object counts();

  const ArrayRef<std::unique_ptr<PlacedPlan>> Plans;
  const Options &Opts;
  MapVector<std::string, Merged, StringMap<unsigned>> ByKey;
  std::vector<json::Object> Comparisons;
};

} // namespace

/// Adds \p Alike, of one key, to \p To.
void UnitDescriber::merge(Merged &To, ArrayRef<const PlannedComparison *> Alike,
                          const Plan &Of) {
  using Instance =
      std::pair<const PlannedInstance *, const PlannedComparison *>;
  SmallVector<Instance, 4> All;
  for (const PlannedComparison *C : Alike)
    for (const PlannedInstance &I : C->Instances)
      All.emplace_back(&I, C);
  sort(All, [](const Instance &A, const Instance &B) {
    return A.first->Number < B.first->Number;
  });
  // In the order of Describer::comparisons().
  for (size_t N = 1; N < All.size(); ++N)
    if (All[N].first->Distance < All.front().first->Distance)
      std::swap(All.front(), All[N]);
  for (auto [I, C] : All) {
    To.LoopDepth = std::max(To.LoopDepth, I->LoopDepth);
    for (uint64_t Read : I->Reads) {
      const json::Object &At = Of.Parameters[Read].Info;
      json::Value Place =
          json::Object{{"file", Opts.relative(textOf(At, "file"))},
                       {"lineno", At.getInteger("lineno").value_or(0)}};
      if (!is_contained(To.Reads, Place))
        To.Reads.push_back(std::move(Place));
    }
  }
  auto [Nearest, C] = All.front();
  if (Nearest->Distance < To.Distance) {
    To.Distance = Nearest->Distance;
    To.Info = relative(C->Info, Opts);
  }
  To.Processes.push_back(Of.Process);
}

void UnitDescriber::mergeComparisons(const PlacedPlan &P) {
  MapVector<std::string, SmallVector<const PlannedComparison *, 1>,
            StringMap<unsigned>>
      Here;
  for (const PlannedComparison &C : P.Of.Comparisons)
    if (P.Functions->isHere(C.Function))
      Here[comparisonKey(nameOfComparison(C.Key->Parts, Opts), C.Key->Ordinal)]
          .push_back(&C);
  for (auto &[Key, Alike] : Here)
    merge(ByKey[Key], Alike, P.Of);
}

void UnitDescriber::sortComparisons() {
  for (auto &[Key, C] : ByKey) {
    C.Info["key"] = Key;
    C.Info["loop_depth"] = C.LoopDepth;
    C.Info["param_reads"] = std::move(C.Reads);
    C.Info["processes"] = std::move(C.Processes);
    Comparisons.push_back(std::move(C.Info));
  }
  sort(Comparisons, [](const json::Object &A, const json::Object &B) {
    auto Order = [](const json::Object &C) {
      return std::make_tuple(placeOf(C), textOf(C, "source"), textOf(C, "key"));
    };
    return Order(A) < Order(B);
  });
}

/// The entries of all plans, each once.
json::Array UnitDescriber::entries(std::vector<PlannedEntry> Plan::*List) {
  json::Array All;
  StringSet<> OfEarlier;
  for (const auto &P : Plans) {
    // One plan may have equal entries, as an analysis may.
    std::vector<std::string> Own;
    for (const PlannedEntry &E : P->Of.*List) {
      if (!P->Functions->isHere(E.Function))
        continue;
      json::Object O = relative(E.Info, Opts);
      if (E.Key)
        O["key"] = readKey(E.Key->Parts, Opts);
      json::Value V = std::move(O);
      if (Plans.size() > 1) {
        Own.push_back(formatv("{0}", V));
        if (OfEarlier.contains(Own.back()))
          continue;
      }
      All.push_back(std::move(V));
    }
    for (const std::string &Text : Own)
      OfEarlier.insert(Text);
  }
  return All;
}

/// The places of all plans, each once, without those of comparisons; \p Name is
/// the field with the parameter.
ListedPlaces UnitDescriber::places(std::vector<PlannedEntry> Plan::*List,
                                   StringRef Name) {
  using Key = std::tuple<unsigned, EntryPlace, std::string>;
  std::map<Key, const PlannedEntry *> All;
  std::set<std::pair<EntryPlace, std::string>> Exposed;
  if (List == &Plan::NotExposed)
    for (const json::Object &C : Comparisons)
      Exposed.insert({placeOf(C), textOf(C, "source")});
  for (const auto &P : Plans)
    for (const PlannedEntry &E : P->Of.*List) {
      if (!P->Functions->isHere(E.Function))
        continue;
      EntryPlace Place = placeOf(E.Info);
      std::get<0>(Place) = Opts.relative(std::get<0>(Place));
      std::string Parameter = textOf(E.Info, Name);
      if (!Exposed.count({Place, Parameter}))
        All.try_emplace({BlindSpot::rankOf(textOf(E.Info, "kind")),
                         std::move(Place), std::move(Parameter)},
                        &E);
    }
  ListedPlaces Out;
  std::set<std::pair<unsigned, std::string>> Listed;
  for (const auto &[At, E] : All) {
    const auto &[Kind, Place, Parameter] = At;
    bool IsFirst = E->Info.get(Name)->kind() != json::Value::Null &&
                   Listed.insert({Kind, Parameter}).second;
    if (Out.add(IsFirst))
      Out.List.push_back(relative(E->Info, Opts));
  }
  return Out;
}

json::Object UnitDescriber::counts() {
  // Two plans counted the same function.
  std::array<uint64_t, FunctionCounts::Size> Sum{};
  std::map<Function *, std::array<uint64_t, FunctionCounts::Size>> ByFunction;
  uint64_t GivenUp = 0;
  for (const auto &P : Plans) {
    std::map<Function *, std::array<uint64_t, FunctionCounts::Size>> Own;
    GivenUp = std::max(GivenUp, P->Of.GivenUp);
    for (const FunctionCounts &Row : P->Of.Counts)
      if (Function *F = P->Functions->servedHere(Row.Function))
        for (unsigned N = 0; N < Row.Of.size(); ++N)
          Own[F][N] += Row.Of[N];
    for (auto &[F, Row] : Own)
      for (unsigned N = 0; N < Row.size(); ++N)
        ByFunction[F][N] = std::max(ByFunction[F][N], Row[N]);
  }
  for (auto &[F, Row] : ByFunction)
    for (unsigned N = 0; N < Row.size(); ++N)
      Sum[N] += Row[N];
  const int64_t Constants = count_if(Comparisons, [](const json::Object &C) {
    return C.getString("type") == "constant";
  });
  return json::Object{
      {"functions", Sum[FunctionCounts::Defined]},
      {"predicates", Sum[FunctionCounts::Predicates]},
      {"predicates_in_slice", Sum[FunctionCounts::InSlice]},
      {"comparisons", static_cast<int64_t>(Comparisons.size()) - Constants},
      {"constants", Constants},
      {"indirect_calls", Sum[FunctionCounts::IndirectCalls]},
      {"without_debug_info", Sum[FunctionCounts::NoDebugInfo]},
      {"outside_sources", Sum[FunctionCounts::Outside]},
      {"lost_values", Sum[FunctionCounts::Lost]},
      {"given_up", GivenUp},
      {"not_instrumented", 0}};
}

UnitInfo UnitDescriber::run() {
  UnitInfo Unit{headerOf(Opts), {}};
  json::Array Processes;
  for (const auto &P : Plans)
    mergeComparisons(*P);
  sortComparisons();
  json::Object Counts = counts();
  json::Array Parameters = entries(&Plan::Parameters);
  json::Array Exposing = entries(&Plan::Exposing);
  ListedPlaces NotExposed = places(&Plan::NotExposed, "source");
  ListedPlaces BlindSpots = places(&Plan::BlindSpots, "parameter");
  Counts["parameter_reads"] = Parameters.size();
  Counts["dynamic_names"] = count_if(Parameters, [](const json::Value &V) {
    return isDynamic(textOf(*V.getAsObject(), "name"));
  });
  Counts["exposing_statements"] = Exposing.size();
  Counts["not_exposed"] = NotExposed.Count;
  Counts["blind_spots"] = BlindSpots.Count;
  for (const auto &P : Plans)
    if (P->givesSomething())
      Processes.push_back(P->Of.Process);
  for (json::Object &C : Comparisons)
    Unit.Comparisons.push_back(writtenComparison(std::move(C)));
  Unit.Fields["processes"] = std::move(Processes);
  Unit.Fields["status"] = "ok";
  Unit.Fields["failure"] = nullptr;
  Unit.Fields["counts"] = std::move(Counts);
  Unit.Fields["parameters"] = std::move(Parameters);
  Unit.Fields["exposing"] = std::move(Exposing);
  Unit.Fields["not_exposed"] = std::move(NotExposed.List);
  Unit.Fields["blind_spots"] = std::move(BlindSpots.List);
  return Unit;
}

bool PlacedPlan::givesSomething() const {
  auto IsHere = [&](const auto &Entry) {
    return Functions->isHere(Entry.Function);
  };
  return any_of(Of.Comparisons, IsHere) || any_of(Of.Parameters, IsHere) ||
         any_of(Of.Exposing, IsHere) || any_of(Of.NotExposed, IsHere) ||
         any_of(Of.BlindSpots, IsHere);
}

UnitInfo describePlanned(ArrayRef<std::unique_ptr<PlacedPlan>> Plans,
                         const Options &Opts) {
  return UnitDescriber(Plans, Opts).run();
}

} // namespace tpc
