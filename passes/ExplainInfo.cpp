//===- ExplainInfo.cpp ----------------------------------------------------===//
#include "ExplainInfo.h"

#include "Names.h"

#include <map>

using namespace llvm;

namespace tpc {

/// Blind spots, and comparisons that are not exposed, that are listed; all are
/// counted.
static constexpr size_t MaxListed = 200;

json::Array shortened(json::Array List) {
  while (List.size() > MaxListed)
    List.pop_back();
  return List;
}

json::Value SourceLines::line(StringRef Path, unsigned Number) {
  auto [It, New] = Files.try_emplace(Path);
  if (New)
    if (auto Buffer = MemoryBuffer::getFile(Path)) {
      It->second.Text = std::move(*Buffer);
      It->second.Text->getBuffer().split(It->second.Lines, '\n');
    }
  if (Number == 0 || Number > It->second.Lines.size())
    return nullptr;
  return json::fixUTF8(It->second.Lines[Number - 1].trim());
}

ExplainInfo::ExplainInfo(Module &M, ModuleAnalysisManager &AM,
                         const Options &Opts)
    : Opts(Opts), Usage(AM.getResult<ParamUsageFinder>(M)),
      Reads(AM.getResult<ParamCallFinder>(M)),
      Gathered(AM.getResult<GatherResults>(M)),
      Calls(AM.getResult<SimpleCallGraph>(M)),
      Words(AM.getResult<ClassObjectAccess>(M),
            AM.getResult<ExternCallFinder>(M), Opts),
      Explain(Usage, AM.getResult<BackwardPropagate>(M), Reads,
              AM.getResult<ExternCallFinder>(M), Calls, Words) {}

/// `file`, `lineno`, `column`, `function` and the line's text.
json::Object ExplainInfo::placed(const DILocation *Loc) {
  if (!Loc)
    return json::Object{{"file", ""},
                        {"lineno", 0},
                        {"column", 0},
                        {"function", ""},
                        {"source_code", nullptr}};
  std::string Path = pathOf(Loc);
  std::string Function;
  if (const DISubprogram *In = Loc->getScope()->getSubprogram())
    Function = In->getLinkageName().empty()
                   ? In->getName().str()
                   : qualifiedName(In->getLinkageName());
  return json::Object{{"file", json::fixUTF8(Opts.relative(Path))},
                      {"lineno", Loc->getLine()},
                      {"column", Loc->getColumn()},
                      {"function", json::fixUTF8(Function)},
                      {"source_code", Lines.line(Path, Loc->getLine())}};
}

json::Array ExplainInfo::path(const Comparison &C) {
  json::Array List;
  size_t Most = Explainer::stepsFor(Gathered.Comparisons.size());
  for (const PathStep &S : Explain.path(C, Most)) {
    json::Object O = placed(S.Loc);
    O["step"] = S.kindName();
    O["what"] = json::fixUTF8(S.What);
    List.push_back(std::move(O));
  }
  return List;
}

using Place = std::tuple<std::string, int64_t, int64_t, std::string>;

static Place placeOf(const json::Object &O, StringRef Parameter) {
  return {O.getString("file")->str(), *O.getInteger("lineno"),
          *O.getInteger("column"), Parameter.str()};
}

json::Array ExplainInfo::notExposed(const json::Array &Comparisons) {
  std::map<Place, json::Object> Found;
  for (const NotReported &N : Gathered.Others) {
    const DILocation *Loc = Words.userPlace(N.Compared->place());
    if (N.Why != NotReported::NotExposed || !Loc)
      continue;
    const ParameterRead &Read = Reads[N.Compared->Read];
    json::Object O = placed(Loc);
    O["source"] = json::fixUTF8(Read.Name);
    Place P = placeOf(O, *O.getString("source"));
    Found.try_emplace(std::move(P), std::move(O));
  }
  for (const json::Value &V : Comparisons) {
    const json::Object &C = *V.getAsObject();
    Found.erase(placeOf(C, C.getString("source").value_or("")));
  }
  json::Array List;
  for (auto &[P, O] : Found)
    List.push_back(std::move(O));
  return List;
}

json::Array ExplainInfo::blindSpots() {
  std::map<std::pair<BlindSpot::KindTy, Place>, json::Object> Found;
  for (const BlindSpot &S :
       findBlindSpots(Usage, Reads, Gathered, Calls, Words)) {
    const DILocation *Loc = Words.userPlace(*S.At);
    // What a library does inside is its own business, and is counted.
    if (!Loc && S.At->getDebugLoc())
      continue;
    json::Object O = placed(Loc);
    Place P = placeOf(O, S.Parameter);
    O["kind"] = S.kindName();
    O["parameter"] = S.Parameter.empty()
                         ? json::Value(nullptr)
                         : json::Value(json::fixUTF8(S.Parameter));
    O["what"] = json::fixUTF8(S.What);
    Found.try_emplace({S.Kind, std::move(P)}, std::move(O));
  }
  json::Array List;
  for (auto &[Key, O] : Found)
    List.push_back(std::move(O));
  return List;
}

} // namespace tpc
