//===- Describer.cpp ------------------------------------------------------===//
#include "output/Describer.h"

#include "params/Texts.h"
#include "support/Functions.h"
#include "support/Names.h"

using namespace llvm;

namespace tpc {

static json::Value textOrNull(StringRef Text) {
  if (Text.empty())
    return nullptr;
  return json::fixUTF8(Text);
}

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

/// The messages of other nodes that \p C depends on.
json::Array Describer::received(const Comparison &C) {
  json::Array List;
  for (const ReceivedMessage &R : Received.of(C)) {
    const DILocation *Loc = R.From->At->getDebugLoc();
    List.push_back(
        json::Object{{"topic", textOrNull(R.From->Topic)},
                     {"type", textOrNull(R.From->Type)},
                     {"by", R.IsValue ? "value" : "control"},
                     {"file", json::fixUTF8(Opts.relative(pathOf(Loc)))},
                     {"lineno", Loc ? Loc->getLine() : 0}});
  }
  return List;
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
  const auto *Shows = dyn_cast<CallBase>(Nearest.At);
  if (std::string Type = Shows && Nearest.IsCall ? Received.typeOf(*Shows) : "";
      !Type.empty())
    O["message"] = std::move(Type);
  if (Read)
    O["path"] = Explain.path(C);
  if (json::Array From = Read ? received(C) : json::Array(); !From.empty())
    O["received"] = std::move(From);
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

} // namespace tpc
