//===- StaticInfo.cpp -----------------------------------------------------===//
#include "StaticInfo.h"

#include "ClassObjectAccess.h"
#include "ExplainInfo.h"
#include "ExternCallFinder.h"
#include "Functions.h"
#include "IfStatements.h"
#include "Names.h"
#include "ParamCallFinder.h"
#include "SimpleCallGraph.h"
#include "Texts.h"
#include "Variables.h"

#include "llvm/Config/llvm-config.h"
#include "llvm/IR/Module.h"
#include "llvm/Support/FileSystem.h"
#include "llvm/Support/Path.h"

using namespace llvm;

namespace tpc {

static constexpr int SchemaVersion = 1;

static std::string textOr(StringRef Text, StringRef Else) {
  return json::fixUTF8(Text.empty() ? Else : Text);
}

static json::Value textOrNull(StringRef Text) {
  if (Text.empty())
    return nullptr;
  return json::fixUTF8(Text);
}

namespace {

/// Writes down what the analyses of a module found.
class Describer {
public:
  Describer(Module &M, ModuleAnalysisManager &AM, const Options &Opts)
      : M(M), Opts(Opts), Access(AM.getResult<ClassObjectAccess>(M)),
        Ifs(AM.getResult<IfStatements>(M)),
        Exposing(AM.getResult<ExternCallFinder>(M)),
        Reads(AM.getResult<ParamCallFinder>(M)),
        Calls(AM.getResult<SimpleCallGraph>(M)),
        Usage(AM.getResult<ParamUsageFinder>(M)),
        Slice(AM.getResult<BackwardPropagate>(M)),
        Gathered(AM.getResult<GatherResults>(M)),
        Names(Access.types(), Access.debugTypes()), Explain(M, AM, Opts) {}

  json::Array parameters() const;
  json::Array exposing() const;
  json::Array comparisons();
  ExplainInfo &explain() { return Explain; }
  json::Object counts(const json::Array &Comparisons) const;

private:
  json::Object placed(const DILocation *Loc, const Function &F) const;
  json::Object placed(const Instruction &I) const {
    return placed(I.getDebugLoc(), *I.getFunction());
  }
  json::Value where(const Instruction &I) const;
  json::Object comparison(const Comparison &C);
  std::string variable(const Comparison &C) const;

  Module &M;
  const Options &Opts;
  const AccessResult &Access;
  const IfStatementsResult &Ifs;
  const ExternCallFinder::Result &Exposing;
  const ParamCallFinder::Result &Reads;
  const CallGraphResult &Calls;
  const ParameterUsage &Usage;
  const SliceResult &Slice;
  const GatheredResults &Gathered;
  VariableNames Names;
  ExplainInfo Explain;
  SourceLines Lines;
};

} // namespace

/// `file`, `lineno`, `column` and `function` of \p Loc, which may have been
/// inlined into \p F.
json::Object Describer::placed(const DILocation *Loc, const Function &F) const {
  const DISubprogram *SP = Loc ? Loc->getScope()->getSubprogram() : nullptr;
  return json::Object{{"file", json::fixUTF8(Opts.relative(pathOf(Loc)))},
                      {"lineno", Loc ? Loc->getLine() : 0},
                      {"column", Loc ? Loc->getColumn() : 0},
                      {"function", json::fixUTF8(SP && SP != F.getSubprogram()
                                                     ? functionNameFor(*Loc)
                                                     : functionName(F))}};
}

json::Value Describer::where(const Instruction &I) const {
  const DILocation *Loc = I.getDebugLoc();
  return json::Object{{"file", json::fixUTF8(Opts.relative(pathOf(Loc)))},
                      {"lineno", Loc ? Loc->getLine() : 0}};
}

json::Array Describer::parameters() const {
  json::Array List;
  for (const ParameterRead &R : Reads) {
    json::Object O = placed(*R.Call);
    O["name"] = json::fixUTF8(R.Name);
    O["api"] = R.Row->Function;
    O["type"] = R.Type;
    O["default"] = R.Default;
    List.push_back(std::move(O));
  }
  return List;
}

json::Array Describer::exposing() const {
  json::Array List;
  for (const ExposingStatement &E : Exposing) {
    json::Object O = placed(*E.Call);
    O["api"] = E.Row->Function;
    O["topic"] = textOrNull(E.Topic);
    List.push_back(std::move(O));
  }
  return List;
}

/// The variable that holds the threshold where it is compared; else the one
/// that the parameter was read into.
std::string Describer::variable(const Comparison &C) const {
  const Value *V = C.Compare ? C.Compare->getOperand(C.Threshold) : C.FlagValue;
  while (true) {
    if (const auto *Cast = dyn_cast<CastInst>(V))
      V = Cast->getOperand(0);
    else if (const auto *NotZero = dyn_cast<CmpInst>(V))
      V = NotZero->getOperand(isa<Constant>(NotZero->getOperand(0)) ? 1 : 0);
    else
      break;
  }
  if (C.Type == Comparison::Constant)
    return C.ConstantName;
  const Value *Target = Reads[C.Reads.front()].Target;
  const auto *Load = dyn_cast<LoadInst>(V);
  for (const Value *Pointer :
       {Load ? Load->getPointerOperand() : nullptr, Target})
    if (Pointer)
      for (const Location &L : Access.resolve(Pointer, true))
        if (std::string Name = Names.nameOf(L); !Name.empty())
          return Name;
  return "";
}

static json::Value describeTransform(const Transform &T) {
  switch (T.kind()) {
  case Transform::None:
    return nullptr;
  case Transform::Affine:
    return json::Object{{"kind", "affine"},
                        {"scale", T.Scale},
                        {"offset", T.Offset},
                        {"text", T.text()}};
  case Transform::Expression:
    return json::Object{
        {"kind", "expression"}, {"text", T.text()}, {"tree", T.tree()}};
  }
  llvm_unreachable("no such kind");
}

json::Object Describer::comparison(const Comparison &C) {
  // A constant is read nowhere.
  const ParameterRead *Read =
      C.Reads.empty() ? nullptr : &Reads[C.Reads.front()];
  const ExposingStatement &Nearest = Exposing[C.Slice.Exposing];
  json::Array ReadPlaces;
  for (unsigned N : C.Reads)
    ReadPlaces.push_back(where(*Reads[N].Call));
  json::Object O = placed(C.Where, *C.place().getFunction());
  O["key"] = C.Key;
  O["type"] = C.typeName();
  O["name"] = textOrNull(variable(C));
  O["source"] = Read ? json::Value(json::fixUTF8(Read->Name)) : nullptr;
  O["distance"] = C.Slice.Distance;
  O["relation"] = C.relation();
  O["topic"] = textOrNull(Nearest.Topic);
  O["source_code"] = Lines.line(pathOf(C.Where), C.Where->getLine());
  O["other_thresholds"] = C.OtherThresholds;
  O["param_reads"] = std::move(ReadPlaces);
  O["publishes"] = json::Array{where(*Nearest.Call)};
  O["transform"] = describeTransform(C.How);
  O["default"] = Read ? Read->Default : nullptr;
  O["read_at"] = Read ? where(*Read->Call) : nullptr;
  O["exposed_at"] = where(*Nearest.Call);
  if (Read)
    O["path"] = Explain.path(C);
  return O;
}

/// The comparisons in the order of the source; one a key: several instances of
/// a template are one place, and the nearest one speaks for them.
json::Array Describer::comparisons() {
  std::vector<json::Object> All;
  StringMap<size_t> Known;
  for (const auto *Kind : {&Gathered.Comparisons, &Gathered.Constants})
    for (const Comparison &C : *Kind) {
      json::Object O = comparison(C);
      auto [It, New] = Known.try_emplace(C.Key, All.size());
      if (New) {
        All.push_back(std::move(O));
        continue;
      }
      json::Object &Same = All[It->second];
      json::Array Places = *O.getArray("param_reads");
      for (const json::Value &Place : *Same.getArray("param_reads"))
        if (!is_contained(Places, Place))
          Places.push_back(Place);
      if (*O.getInteger("distance") < *Same.getInteger("distance"))
        Same = std::move(O);
      Same["param_reads"] = std::move(Places);
    }
  auto Order = [](const json::Object &O) {
    return std::make_tuple(
        *O.getString("file"), *O.getInteger("lineno"), *O.getInteger("column"),
        O.getString("source").value_or(""), *O.getString("key"));
  };
  sort(All, [&](const json::Object &A, const json::Object &B) {
    return Order(A) < Order(B);
  });
  json::Array List;
  for (json::Object &O : All)
    List.push_back(std::move(O));
  return List;
}

json::Object Describer::counts(const json::Array &Comparisons) const {
  int64_t Constants = count_if(Comparisons, [](const json::Value &V) {
    return V.getAsObject()->getString("type") == "constant";
  });
  return json::Object{
      {"functions", range_size(definedFunctions(M))},
      {"predicates", static_cast<int64_t>(Ifs.predicates().size())},
      {"predicates_in_slice", Slice.numPredicates()},
      {"parameter_reads", static_cast<int64_t>(Reads.size())},
      {"exposing_statements", static_cast<int64_t>(Exposing.size())},
      {"comparisons", static_cast<int64_t>(Comparisons.size()) - Constants},
      {"constants", Constants},
      {"dynamic_names",
       count_if(Reads,
                [](const ParameterRead &R) { return isDynamic(R.Name); })},
      {"indirect_calls", static_cast<int64_t>(Calls.unresolved().size())},
      {"without_debug_info", Gathered.WithoutDebugInfo},
      {"outside_sources", Gathered.OutsideSources},
      {"lost_values", Usage.lost()},
      {"not_instrumented", 0}};
}

/// What every file says, analysis or not.
static json::Object header(const Options &Opts) {
  return json::Object{{"schema", SchemaVersion},
                      {"link_unit", json::fixUTF8(Opts.LinkUnit)},
                      {"package", textOr(Opts.Package, "unnamed")},
                      {"source_root", json::fixUTF8(Opts.SourceRoot)},
                      {"tool", json::Object{{"name", "tpc"},
                                            {"version", TPC_VERSION},
                                            {"llvm", LLVM_VERSION_STRING},
                                            {"profile", Opts.Profile}}}};
}

json::Object describe(Module &M, ModuleAnalysisManager &AM,
                      const Options &Opts) {
  Describer D(M, AM, Opts);
  json::Object Unit = header(Opts);
  json::Array Comparisons = D.comparisons();
  Unit["status"] = "ok";
  Unit["failure"] = nullptr;
  json::Object Counts = D.counts(Comparisons);
  ListedPlaces NotExposed = D.explain().notExposed(Comparisons);
  ListedPlaces BlindSpots = D.explain().blindSpots();
  Counts["not_exposed"] = static_cast<int64_t>(NotExposed.Count);
  Counts["blind_spots"] = static_cast<int64_t>(BlindSpots.Count);
  Unit["counts"] = std::move(Counts);
  Unit["parameters"] = D.parameters();
  Unit["exposing"] = D.exposing();
  Unit["comparisons"] = std::move(Comparisons);
  Unit["not_exposed"] = std::move(NotExposed.List);
  Unit["blind_spots"] = std::move(BlindSpots.List);
  return Unit;
}

json::Object describeFailure(const Options &Opts, StringRef Why,
                             const json::Object *Known) {
  json::Object Unit = header(Opts);
  Unit["status"] = "failed";
  Unit["failure"] = json::fixUTF8(Why);
  json::Object Counts;
  for (StringRef Name :
       {"functions", "predicates", "predicates_in_slice", "parameter_reads",
        "exposing_statements", "comparisons", "constants", "dynamic_names",
        "indirect_calls", "without_debug_info", "outside_sources",
        "lost_values", "not_instrumented", "not_exposed", "blind_spots"})
    Counts[Name] = 0;
  if (Known)
    Counts = *Known;
  Counts["comparisons"] = 0;
  Unit["counts"] = std::move(Counts);
  for (StringRef Name :
       {"parameters", "exposing", "comparisons", "not_exposed", "blind_spots"})
    Unit[Name] = json::Array();
  return Unit;
}

Error writeJson(json::Object Unit, StringRef Path) {
  StringRef Folder = sys::path::parent_path(Path);
  if (!Folder.empty())
    if (std::error_code EC = sys::fs::create_directories(Folder))
      return createFileError(Path, EC);
  return writeToOutput(Path, [&](raw_ostream &OS) {
    json::OStream(OS, /*IndentSize=*/1).value(std::move(Unit));
    OS << '\n';
    return Error::success();
  });
}

} // namespace tpc
