//===- StaticInfo.cpp -----------------------------------------------------===//
#include "output/StaticInfo.h"

#include "output/Describer.h"

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

json::Object headerOf(const Options &Opts) {
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
std::string writtenComparison(json::Object O) {
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
  UnitInfo Unit{headerOf(Opts), {}};
  const std::vector<SourcePlace> Comparisons = D.comparisons();
  for (const SourcePlace &P : Comparisons)
    Unit.Comparisons.push_back(writtenComparison(D.comparison(P)));
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
  UnitInfo Unit{headerOf(Opts), {}};
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
