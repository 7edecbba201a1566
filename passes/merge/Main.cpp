//===- Main.cpp - tpc-merge -----------------------------------------------===//
//
// Makes one module of the link units of a process, for the analysis:
//
//   tpc-merge UNITS.json -o PROCESS.bc
//
// docs/reference/formats.md describes UNITS.json and what is printed. What
// cannot be read is left out and said; the rest is merged.
//
//===----------------------------------------------------------------------===//
#include "merge/Merger.h"

#include "llvm/Bitcode/BitcodeWriter.h"
#include "llvm/IR/Verifier.h"
#include "llvm/Support/CommandLine.h"
#include "llvm/Support/FileSystem.h"
#include "llvm/Support/InitLLVM.h"
#include "llvm/Support/JSON.h"
#include "llvm/Support/ToolOutputFile.h"
#include "llvm/Support/WithColor.h"

using namespace llvm;
using namespace tpc;

static cl::OptionCategory Category("tpc-merge");
static cl::opt<std::string> UnitsOpt(cl::Positional, cl::Required,
                                     cl::cat(Category), cl::desc("UNITS.json"));
static cl::opt<std::string> OutputOpt("o", cl::Required, cl::cat(Category),
                                      cl::value_desc("PROCESS.bc"),
                                      cl::desc("Where the module is written"));

// LLVM looks for these beside what they read.
namespace tpc {
static bool fromJSON(const json::Value &V, UnitFiles::File &File,
                     json::Path P) {
  json::ObjectMapper O(V, P);
  return O && O.map("path", File.Path) && O.mapOptional("whole", File.Whole) &&
         O.mapOptional("lazy", File.Lazy);
}

static bool fromJSON(const json::Value &V, UnitFiles &Unit, json::Path P) {
  json::ObjectMapper O(V, P);
  return O && O.map("name", Unit.Name) && O.map("files", Unit.Files);
}
} // namespace tpc

static int fail(StringRef File, const Twine &Text) {
  WithColor::error(errs(), "tpc-merge") << File << ": " << Text << '\n';
  return 1;
}

namespace {
/// What is merged: docs/reference/formats.md.
struct Input {
  std::vector<UnitFiles> Units;
  std::vector<std::vector<std::string>> Scopes;
  std::vector<std::string> Without;
};
} // namespace

static Expected<Input> readInput(StringRef Text) {
  Expected<json::Value> Parsed = json::parse(Text);
  if (!Parsed)
    return Parsed.takeError();
  json::Path::Root Root("list");
  json::ObjectMapper O(*Parsed, Root);
  Input In;
  if (!O || !O.map("units", In.Units) || !O.mapOptional("scopes", In.Scopes) ||
      !O.mapOptional("without", In.Without))
    return Root.getError();
  return In;
}

static json::Object summary(Merger &Merged, ArrayRef<UnitFiles> Units) {
  json::Array Names, Missing;
  for (auto [Unit, Functions] : zip_equal(Units, Merged.functions()))
    Names.push_back(json::Object{{"name", Unit.Name},
                                 {"functions", json::Array(Functions)}});
  for (const LeftOut &One : Merged.leftOut())
    Missing.push_back(
        json::Object{{"unit", One.Unit}, {"file", One.File}, {"why", One.Why}});
  int64_t Count = count_if(
      Merged.module(), [](const Function &F) { return !F.isDeclaration(); });
  return json::Object{{"functions", Count},
                      {"units", std::move(Names)},
                      {"left_out", std::move(Missing)}};
}

int main(int Count, char **Words) {
  InitLLVM Init(Count, Words);
  cl::HideUnrelatedOptions(Category);
  cl::ParseCommandLineOptions(
      Count, Words, "Makes one module of the link units of a process\n");
  auto Text = MemoryBuffer::getFile(UnitsOpt);
  if (!Text)
    return fail(UnitsOpt, Text.getError().message());
  Expected<Input> In = readInput((*Text)->getBuffer());
  if (!In)
    return fail(UnitsOpt, toString(In.takeError()));
  Merger Merged;
  for (const UnitFiles &Unit : In->Units)
    Merged.add(Unit);
  Merged.join(In->Scopes);
  Merged.withoutPlugins(In->Without);
  Merged.removeUnreached();
  std::string Why;
  raw_string_ostream OS(Why);
  bool HasBrokenDebugInfo = false;
  if (verifyModule(Merged.module(), &OS, &HasBrokenDebugInfo))
    return fail(OutputOpt,
                "the merged module does not verify: " + StringRef(Why).trim());
  std::error_code Bad;
  ToolOutputFile Out(OutputOpt, Bad, sys::fs::OF_None);
  if (Bad)
    return fail(OutputOpt, Bad.message());
  WriteBitcodeToFile(Merged.module(), Out.os());
  Out.keep();
  outs() << json::Value(summary(Merged, In->Units)) << '\n';
  return 0;
}
