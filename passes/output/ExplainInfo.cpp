//===- ExplainInfo.cpp ----------------------------------------------------===//
#include "output/ExplainInfo.h"

#include "support/Names.h"

#include "llvm/ADT/DenseSet.h"
#include "llvm/ADT/SmallPtrSet.h"
#include "llvm/Support/CommandLine.h"

#include <map>

using namespace llvm;

namespace tpc {

/// Nobody reads more, and every diagnosis reads the file. All of them are
/// counted, and each parameter has one of each kind.
static cl::opt<unsigned> MaxListed(
    "tpc-max-listed", cl::Hidden, cl::init(200),
    cl::desc("Blind spots and unexposed comparisons that are listed"));

bool ListedPlaces::add(bool IsFirst) { return Count++ < MaxListed || IsFirst; }

namespace {

/// The entries to list: each place and parameter once (or, if they are told
/// apart, once for each function), ordered by kind, place and name. A large
/// link unit has millions, so only numbers are kept until it is known which few
/// are written.
class Listing {
public:
  using Place = std::tuple<std::string, unsigned, unsigned>;
  struct Entry {
    unsigned Kind, Place, Name, Index;
    const Function *In = nullptr; // if functions are told apart
    auto key() const { return std::make_tuple(Kind, Place, Name); }
  };

  Listing(const ParamCallFinder::Result &Reads, const Options &Opts)
      : Opts(Opts) {
    for (const ParameterRead &R : Reads)
      Names.try_emplace(R.Name, 0);
    unsigned Rank = 0;
    for (auto &[Name, Number] : Names)
      Number = ++Rank; // 0 is for entries without a parameter
    for (const ParameterRead &R : Reads)
      NameOf.push_back(Names.at(R.Name));
  }

  void add(unsigned Kind, const DILocation *Loc, unsigned Read, unsigned Index,
           const Function *In) {
    auto [It, New] = PlaceOf.try_emplace(Loc, 0);
    if (New)
      Places[place(Loc)].push_back(Loc);
    Waiting.push_back({{Kind, 0, nameOf(Read), Index, In}, Loc});
  }

  /// The parameter \p Name at \p P, as the place and name of an entry.
  std::optional<std::pair<unsigned, unsigned>> at(const Place &P,
                                                  const std::string &Name) {
    auto Found = Places.find(P);
    auto Named = Names.find(Name);
    if (Found == Places.end() || Named == Names.end())
      return std::nullopt;
    return std::pair(rank(Found->second.front()), Named->second);
  }

  const std::vector<Entry> &sorted() {
    unsigned Rank = 0;
    for (auto &[P, Locs] : Places) {
      for (const DILocation *Loc : Locs)
        PlaceOf[Loc] = Rank;
      ++Rank;
    }
    for (auto &[E, Loc] : Waiting) {
      E.Place = rank(Loc);
      Entries.push_back(E);
    }
    llvm::sort(Entries, [](const Entry &A, const Entry &B) {
      return std::tuple_cat(A.key(), std::tuple(A.Index)) <
             std::tuple_cat(B.key(), std::tuple(B.Index));
    });
    // The first of those alike; functions may be mixed in between.
    Entry Last{~0U, 0, 0, 0};
    SmallPtrSet<const Function *, 2> Known;
    erase_if(Entries, [&](const Entry &E) {
      if (E.key() != Last.key())
        Known.clear();
      Last = E;
      return !Known.insert(E.In).second;
    });
    return Entries;
  }

private:
  Place place(const DILocation *Loc) const {
    if (!Loc)
      return {"", 0, 0};
    return {Opts.relative(pathOf(Loc)), Loc->getLine(), Loc->getColumn()};
  }
  unsigned nameOf(unsigned Read) const {
    return Read == BlindSpot::None ? 0 : NameOf[Read];
  }
  unsigned rank(const DILocation *Loc) const { return PlaceOf.lookup(Loc); }

  const Options &Opts;
  std::map<std::string, unsigned> Names;
  std::vector<unsigned> NameOf; // by the number of the read
  std::map<Place, SmallVector<const DILocation *, 1>> Places;
  DenseMap<const DILocation *, unsigned> PlaceOf;
  std::vector<std::pair<Entry, const DILocation *>> Waiting;
  std::vector<Entry> Entries;
};

} // namespace

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
      Words(AM.getResult<LocationTypesAnalysis>(M),
            AM.getResult<PointsToAnalysis>(M),
            AM.getResult<ExternCallFinder>(M), Opts),
      Explain(Usage, AM.getResult<BackwardPropagate>(M), Reads,
              AM.getResult<ExternCallFinder>(M), Calls, Words) {}

/// `file`, `lineno`, `column`, `function` and the text of the line.
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
    if (!S.Unit.empty())
      O["unit"] = json::fixUTF8(S.Unit);
    List.push_back(std::move(O));
  }
  return List;
}

ListedPlaces ExplainInfo::notExposed(ArrayRef<SourcePlace> Comparisons,
                                     bool Every) {
  Listing All(Reads, Opts);
  for (auto [Index, N] : enumerate(Gathered.Others))
    if (const DILocation *Loc = Words.userPlace(N.Compared->place());
        Loc && N.Why == NotReported::NotExposed)
      All.add(0, Loc, N.Compared->Read, Index,
              Every ? N.Compared->place().getFunction() : nullptr);
  ListedPlaces Out;
  const std::vector<Listing::Entry> &Sorted = All.sorted();
  DenseSet<std::pair<unsigned, unsigned>> Exposed;
  for (const SourcePlace &P : Comparisons)
    if (auto Known = All.at({P.File, P.Line, P.Column}, P.Source))
      Exposed.insert(*Known);
  DenseSet<unsigned> Listed;
  for (const Listing::Entry &E : Sorted) {
    if (Exposed.contains({E.Place, E.Name}))
      continue;
    bool IsFirst = Listed.insert(E.Name).second;
    if (!Out.add(IsFirst) && !Every)
      continue;
    Out.In.push_back(E.In);
    const ParameterComparison &Compared = *Gathered.Others[E.Index].Compared;
    json::Object O = placed(Words.userPlace(Compared.place()));
    O["source"] = json::fixUTF8(Reads[Compared.Read].Name);
    Out.List.push_back(std::move(O));
  }
  return Out;
}

ListedPlaces ExplainInfo::blindSpots(bool Every) {
  const std::vector<BlindSpot> Spots =
      findBlindSpots(Usage, Reads, Gathered, Calls, Words);
  Listing All(Reads, Opts);
  // Very many values may end at one place.
  DenseMap<const Instruction *, const DILocation *> Places;
  for (auto [Index, S] : enumerate(Spots)) {
    auto [It, New] = Places.try_emplace(S.At);
    if (New)
      It->second = Words.userPlace(*S.At);
    const DILocation *Loc = It->second;
    // Values that end inside a library are only counted.
    if (Loc || !S.At->getDebugLoc())
      All.add(S.Kind, Loc, S.Read, Index,
              Every ? S.At->getFunction() : nullptr);
  }
  ListedPlaces Out;
  DenseSet<std::pair<unsigned, unsigned>> Listed;
  for (const Listing::Entry &E : All.sorted()) {
    const BlindSpot &S = Spots[E.Index];
    bool IsFirst =
        S.Read != BlindSpot::None && Listed.insert({S.Kind, E.Name}).second;
    if (!Out.add(IsFirst) && !Every)
      continue;
    Out.In.push_back(E.In);
    json::Object O = placed(Words.userPlace(*S.At));
    O["kind"] = S.kindName();
    O["parameter"] = S.Read == BlindSpot::None
                         ? json::Value(nullptr)
                         : json::Value(json::fixUTF8(Reads[S.Read].Name));
    O["what"] = json::fixUTF8(S.text(Reads, Words));
    Out.List.push_back(std::move(O));
  }
  return Out;
}

} // namespace tpc
