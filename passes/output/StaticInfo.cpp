//===- StaticInfo.cpp -----------------------------------------------------===//
#include "output/StaticInfo.h"

#include "calls/SimpleCallGraph.h"
#include "control/IfStatements.h"
#include "memory/Variables.h"
#include "memory/VisibleWrites.h"
#include "output/ExplainInfo.h"
#include "params/ParamCallFinder.h"
#include "params/Texts.h"
#include "results/LoopDepths.h"
#include "slice/ExternCallFinder.h"
#include "support/Functions.h"
#include "support/Names.h"

#include "llvm/Config/llvm-config.h"
#include "llvm/IR/Module.h"
#include "llvm/Support/FileSystem.h"
#include "llvm/Support/Path.h"

using namespace llvm;

namespace tpc {

static constexpr int SchemaVersion = 1;
static constexpr unsigned Indent = 1;
static constexpr StringLiteral Comparisons = "comparisons";

static std::string textOr(StringRef Text, StringRef Else) {
  return json::fixUTF8(Text.empty() ? Else : Text);
}

static json::Value textOrNull(StringRef Text) {
  if (Text.empty())
    return nullptr;
  return json::fixUTF8(Text);
}

namespace {

/// Writes what the analyses of a module found.
class Describer {
public:
  Describer(Module &M, ModuleAnalysisManager &AM, const Options &Opts)
      : M(M), Opts(Opts), Writes(AM.getResult<VisibleWritesAnalysis>(M)),
        Pointers(AM.getResult<PointsToAnalysis>(M)),
        Ifs(AM.getResult<IfStatements>(M)),
        Exposing(AM.getResult<ExternCallFinder>(M)),
        Reads(AM.getResult<ParamCallFinder>(M)),
        Calls(AM.getResult<SimpleCallGraph>(M)),
        Usage(AM.getResult<ParamUsageFinder>(M)),
        Slice(AM.getResult<BackwardPropagate>(M)),
        Gathered(AM.getResult<GatherResults>(M)),
        Loops(AM.getResult<LoopDepths>(M)),
        Names(AM.getResult<LocationTypesAnalysis>(M)), Explain(M, AM, Opts) {}

  json::Array parameters() const;
  json::Array exposing() const;
  std::vector<SourcePlace> comparisons() const;
  json::Object comparison(const SourcePlace &P);
  ExplainInfo &explain() { return Explain; }
  json::Object counts(ArrayRef<SourcePlace> Comparisons) const;

private:
  json::Object placed(const DILocation *Loc, const Function &F) const;
  json::Object placed(const Instruction &I) const {
    return placed(I.getDebugLoc(), *I.getFunction());
  }
  json::Value where(const Instruction &I) const;
  std::string source(const Comparison &C) const;
  std::string variable(const Comparison &C) const;

  Module &M;
  const Options &Opts;
  const VisibleWrites &Writes;
  PointsTo &Pointers;
  const IfStatementsResult &Ifs;
  const ExternCallFinder::Result &Exposing;
  const ParamCallFinder::Result &Reads;
  const CallGraphResult &Calls;
  const ParameterUsage &Usage;
  const SliceResult &Slice;
  const GatheredResults &Gathered;
  const LoopDepthsResult &Loops;
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
    if (!R.Key.empty() && !R.Row->Resolve.empty())
      O["key"] = R.Key;
    List.push_back(std::move(O));
  }
  return List;
}

json::Array Describer::exposing() const {
  json::Array List;
  for (const ExposingStatement &E : Exposing) {
    json::Object O = placed(*E.At);
    O["api"] = E.Api;
    O["topic"] = textOrNull(E.Topic);
    List.push_back(std::move(O));
  }
  return List;
}

/// The variable that holds the threshold where it is compared; if there is
/// none, the variable that the parameter was read into.
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
      for (const Location &L : Pointers.resolve(Pointer, true))
        if (std::string Name = Names.nameOf(L); !Name.empty())
          return Name;
  return "";
}

static json::Value describeTransform(const Transform &T) {
  // Of a list, nobody can compute what its parameter should be.
  if (!T.Part.empty())
    return json::Object{{"kind", "expression"}, {"text", T.text()}};
  switch (T.kind()) {
  case Transform::None:
    return nullptr;
  case Transform::Affine:
    return json::Object{{"kind", "affine"},
                        {"scale", T.Scale},
                        {"offset", T.Offset},
                        {"text", T.text()}};
  case Transform::OfParameters:
  case Transform::WithVariables:
    return json::Object{{"kind", "expression"}, {"text", T.text()}};
  case Transform::Expression:
    return json::Object{
        {"kind", "expression"}, {"text", T.text()}, {"tree", T.tree()}};
  }
  llvm_unreachable("no such kind");
}

std::string Describer::source(const Comparison &C) const {
  return C.Reads.empty() ? "" : json::fixUTF8(Reads[C.Reads.front()].Name);
}

json::Object Describer::comparison(const SourcePlace &P) {
  const Comparison &C = *P.Instances.front();
  // A constant has no read.
  const ParameterRead *Read =
      C.Reads.empty() ? nullptr : &Reads[C.Reads.front()];
  const ExposingStatement &Nearest = Exposing[C.Slice.Exposing];
  json::Array ReadPlaces;
  unsigned Depth = 0;
  for (const Comparison *Instance : P.Instances) {
    Depth = std::max(Depth, Loops.of(*Instance));
    for (unsigned N : Instance->Reads)
      if (json::Value Place = where(*Reads[N].Call);
          !is_contained(ReadPlaces, Place))
        ReadPlaces.push_back(std::move(Place));
  }
  json::Object O = placed(C.Where, *C.place().getFunction());
  O["key"] = C.Key;
  O["type"] = C.typeName();
  O["name"] = textOrNull(variable(C));
  O["source"] = Read ? json::Value(P.Source) : nullptr;
  O["distance"] = C.Slice.Distance;
  O["loop_depth"] = Depth;
  O["relation"] = C.relation();
  O["topic"] = textOrNull(Nearest.Topic);
  O["source_code"] = Lines.line(pathOf(C.Where), C.Where->getLine());
  O["other_thresholds"] = C.OtherThresholds;
  O["param_reads"] = std::move(ReadPlaces);
  O["publishes"] = json::Array{where(*Nearest.At)};
  O["transform"] = describeTransform(C.How);
  O["default"] = Read ? Read->Default : nullptr;
  O["read_at"] = Read ? where(*Read->Call) : nullptr;
  O["exposed_at"] = where(*Nearest.At);
  if (Read)
    O["path"] = Explain.path(C);
  return O;
}

/// The comparisons in the order of the source, one for each key. Several
/// instances of a template are one place; the instance nearest to an exposing
/// statement comes first and represents it.
std::vector<SourcePlace> Describer::comparisons() const {
  std::vector<SourcePlace> All;
  StringMap<size_t> Known;
  for (const auto *Kind : {&Gathered.Comparisons, &Gathered.Constants})
    for (const Comparison &C : *Kind) {
      auto [It, New] = Known.try_emplace(C.Key, All.size());
      if (New)
        All.emplace_back();
      auto &Instances = All[It->second].Instances;
      Instances.push_back(&C);
      if (C.Slice.Distance < Instances.front()->Slice.Distance)
        std::swap(Instances.front(), Instances.back());
    }
  for (SourcePlace &P : All) {
    const Comparison &C = *P.Instances.front();
    P.File = json::fixUTF8(Opts.relative(pathOf(C.Where)));
    P.Line = C.Where->getLine();
    P.Column = C.Where->getColumn();
    P.Source = source(C);
  }
  sort(All, [](const SourcePlace &A, const SourcePlace &B) {
    auto Order = [](const SourcePlace &P) {
      return std::tie(P.File, P.Line, P.Column, P.Source,
                      P.Instances.front()->Key);
    };
    return Order(A) < Order(B);
  });
  return All;
}

json::Object Describer::counts(ArrayRef<SourcePlace> Comparisons) const {
  int64_t Constants = count_if(Comparisons, [](const SourcePlace &P) {
    return P.Instances.front()->Type == Comparison::Constant;
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
      {"given_up", Writes.givenUp()},
      {"not_instrumented", 0}};
}

/// The fields that every file has, also if the analysis failed.
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

/// \p O as text, as it stands in an array that is a field of the top object. A
/// JSON object takes kilobytes of memory, and a large link unit has a hundred
/// thousand of them.
static std::string written(json::Object O) {
  std::string Text;
  raw_string_ostream OS(Text);
  json::OStream(OS, Indent).value(std::move(O));
  std::string Shifted;
  for (char C : Text) {
    Shifted += C;
    if (C == '\n')
      Shifted.append(size_t(2) * Indent, ' ');
  }
  return Shifted;
}

UnitInfo describe(Module &M, ModuleAnalysisManager &AM, const Options &Opts) {
  Describer D(M, AM, Opts);
  UnitInfo Unit{header(Opts), {}};
  const std::vector<SourcePlace> Comparisons = D.comparisons();
  for (const SourcePlace &P : Comparisons)
    Unit.Comparisons.push_back(written(D.comparison(P)));
  json::Object Counts = D.counts(Comparisons);
  ListedPlaces NotExposed = D.explain().notExposed(Comparisons);
  ListedPlaces BlindSpots = D.explain().blindSpots();
  Counts["not_exposed"] = static_cast<int64_t>(NotExposed.Count);
  Counts["blind_spots"] = static_cast<int64_t>(BlindSpots.Count);
  Unit.Fields["status"] = "ok";
  Unit.Fields["failure"] = nullptr;
  Unit.Fields["counts"] = std::move(Counts);
  Unit.Fields["parameters"] = D.parameters();
  Unit.Fields["exposing"] = D.exposing();
  Unit.Fields["not_exposed"] = std::move(NotExposed.List);
  Unit.Fields["blind_spots"] = std::move(BlindSpots.List);
  return Unit;
}

UnitInfo describeFailure(const Options &Opts, StringRef Why,
                         const json::Object *Known) {
  UnitInfo Unit{header(Opts), {}};
  Unit.Fields["status"] = "failed";
  Unit.Fields["failure"] = json::fixUTF8(Why);
  json::Object Counts;
  for (StringRef Name :
       {"functions", "predicates", "predicates_in_slice", "parameter_reads",
        "exposing_statements", "comparisons", "constants", "dynamic_names",
        "indirect_calls", "without_debug_info", "outside_sources",
        "lost_values", "given_up", "not_instrumented", "not_exposed",
        "blind_spots"})
    Counts[Name] = 0;
  if (Known)
    Counts = *Known;
  Counts["comparisons"] = 0;
  Unit.Fields["counts"] = std::move(Counts);
  for (StringRef Name :
       {"parameters", "exposing", "not_exposed", "blind_spots"})
    Unit.Fields[Name] = json::Array();
  return Unit;
}

Error writeJson(UnitInfo Unit, StringRef Path) {
  StringRef Folder = sys::path::parent_path(Path);
  if (!Folder.empty())
    if (std::error_code EC = sys::fs::create_directories(Folder))
      return createFileError(Path, EC);
  return writeToOutput(Path, [&](raw_ostream &OS) {
    json::OStream J(OS, Indent);
    SmallVector<StringRef, 16> Names{Comparisons};
    for (auto &Field : Unit.Fields)
      Names.push_back(Field.first);
    sort(Names);
    J.object([&] {
      for (StringRef Name : Names)
        if (Name == Comparisons)
          J.attributeArray(Name, [&] {
            for (const std::string &Text : Unit.Comparisons)
              J.rawValue(Text);
          });
        else
          J.attribute(Name, *Unit.Fields.get(Name));
    });
    OS << '\n';
    return Error::success();
  });
}

} // namespace tpc
