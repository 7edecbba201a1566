//===- Plan.cpp - Plans as JSON -------------------------------------------===//
#include "plan/Plan.h"

#include "llvm/Support/MemoryBuffer.h"

using namespace llvm;

namespace tpc {

using json::ObjectMapper;
using json::Path;

uint64_t Plan::baseNumber(uint64_t Number) const {
  while (Functions[Number].Of)
    Number = *Functions[Number].Of;
  return Number;
}

const PlannedFunction &Plan::base(uint64_t Number) const {
  return Functions[baseNumber(Number)];
}

//===----------------------------------------------------------------------===//
// Reading
//===----------------------------------------------------------------------===//

static bool fromJSON(const json::Value &E, PlannedFunction &F, Path P) {
  ObjectMapper O(E, P);
  if (!O)
    return false;
  if (!O.map("of", F.Of))
    return false;
  if (F.Of)
    return O.map("in", F.In) && O.map("at", F.At) && F.In && F.At;
  return O.map("name", F.Name) && O.map("linkage", F.Linkage) &&
         O.map("file", F.File) && O.map("line", F.Line) &&
         O.map("checksum", F.Checksum) && O.mapOptional("unit", F.Unit);
}

static bool fromJSON(const json::Value &E, PlannedValue &V, Path P) {
  ObjectMapper O(E, P);
  if (!O || !O.map("argument", V.Argument) || !O.map("at", V.At) ||
      !O.map("operand", V.Operand))
    return false;
  if (!V.Argument && !V.At)
    P.report("expected an argument or an instruction");
  return V.Argument || V.At;
}

static bool fromJSON(const json::Value &E, PlannedKey &K, Path P) {
  ObjectMapper O(E, P);
  uint64_t Line = 0, Column = 0;
  if (!O || !O.map("path", K.Parts.Path) ||
      !O.map("function", K.Parts.Function) || !O.map("line", Line) ||
      !O.map("column", Column) || !O.map("what", K.Parts.What) ||
      !O.map("ordinal", K.Ordinal))
    return false;
  K.Parts.Line = Line;
  K.Parts.Column = Column;
  return true;
}

static bool fromJSON(const json::Value &E, PlannedReport &R, Path P) {
  ObjectMapper O(E, P);
  return O && O.map("function", R.Function) && O.map("key", R.Key) &&
         O.map("before", R.Before) && O.map("result", R.Result) &&
         O.map("compared", R.Compared) && O.map("threshold", R.Threshold) &&
         O.map("outcome", R.Outcome) && O.map("object", R.Object) &&
         O.map("held", R.Held) && O.map("switch", R.Switch) &&
         O.map("signed", R.Signed);
}

static bool fromJSON(const json::Value &E, PlannedName &N, Path P) {
  ObjectMapper O(E, P);
  return O && O.map("function", N.Function) && O.map("read", N.Read) &&
         O.map("before", N.Before) && O.map("handle", N.Handle) &&
         O.map("offset", N.Offset) && O.map("name", N.Name) &&
         O.map("text", N.Text) && O.map("is_text", N.IsText) &&
         O.map("object", N.Object) && O.map("size", N.Size) &&
         O.map("node_name", N.NodeName);
}

static bool fromJSON(const json::Value &E, PlannedEntry &Entry, Path P) {
  ObjectMapper O(E, P);
  if (!O || !O.map("function", Entry.Function) || !O.map("key", Entry.Key))
    return false;
  const json::Object *Info = E.getAsObject()->getObject("info");
  if (!Info)
    P.field("info").report("expected object");
  else
    Entry.Info = *Info;
  return Info;
}

static bool fromJSON(const json::Value &E, PlannedInstance &I, Path P) {
  ObjectMapper O(E, P);
  return O && O.map("number", I.Number) && O.map("distance", I.Distance) &&
         O.map("loop_depth", I.LoopDepth) && O.map("reads", I.Reads);
}

static bool fromJSON(const json::Value &E, PlannedComparison &C, Path P) {
  if (!fromJSON(E, static_cast<PlannedEntry &>(C), P) ||
      !ObjectMapper(E, P).map("instances", C.Instances))
    return false;
  if (!C.Key || C.Instances.empty())
    P.report("expected a key and instances");
  return C.Key && !C.Instances.empty();
}

static bool fromJSON(const json::Value &E, FunctionCounts &C, Path P) {
  std::vector<uint64_t> Numbers;
  if (!json::fromJSON(E, Numbers, P))
    return false;
  if (Numbers.size() != FunctionCounts::Size + 1) {
    P.report("expected a function and its counts");
    return false;
  }
  C.Function = Numbers.front();
  std::copy(Numbers.begin() + 1, Numbers.end(), C.Of.begin());
  return true;
}

/// Numbers of functions and parameters must be those of the lists.
static bool check(const Plan &Of, Path P) {
  bool Good = true;
  const uint64_t Functions = Of.Functions.size();
  auto Function = [&](uint64_t Number, Path At) {
    if (Number >= Functions) {
      At.report("no such function");
      Good = false;
    }
  };
  auto Read = [&](uint64_t Number, Path At) {
    if (Number >= Of.Parameters.size()) {
      At.report("no such parameter");
      Good = false;
    }
  };
  for (uint64_t N = 0; N < Functions; ++N)
    if (const PlannedFunction &F = Of.Functions[N]; F.Of) {
      // A copy follows what it is made of, so that no chain is endless.
      Path At = P.field("functions").index(N);
      if (*F.Of >= N || *F.In >= N) {
        At.report("a copy before its function or its caller");
        Good = false;
      }
    }
  auto Each = [&](const auto &List, StringLiteral Name) {
    Path Field = P.field(Name);
    for (size_t N = 0; N < List.size(); ++N)
      Function(List[N].Function, Field.index(N));
  };
  Each(Of.Reports, "reports");
  Each(Of.Names, "names");
  Each(Of.Comparisons, "comparisons");
  Each(Of.Parameters, "parameters");
  Each(Of.Exposing, "exposing");
  Each(Of.NotExposed, "not_exposed");
  Each(Of.BlindSpots, "blind_spots");
  Each(Of.Counts, "counts");
  Path Rounds = P.field("rounds"), Without = P.field("without_report");
  for (size_t N = 0; N < Of.Rounds.size(); ++N)
    for (uint64_t Number : Of.Rounds[N])
      Function(Number, Rounds.index(N));
  for (size_t N = 0; N < Of.WithoutReport.size(); ++N)
    Function(Of.WithoutReport[N], Without.index(N));
  Path Names = P.field("names"), Comparisons = P.field("comparisons");
  for (size_t N = 0; N < Of.Names.size(); ++N)
    Read(Of.Names[N].Read, Names.index(N));
  for (size_t N = 0; N < Of.Comparisons.size(); ++N)
    for (const PlannedInstance &I : Of.Comparisons[N].Instances)
      for (uint64_t Number : I.Reads)
        Read(Number, Comparisons.index(N));
  return Good;
}

static bool fromJSON(const json::Value &E, Plan &Out, Path P) {
  ObjectMapper O(E, P);
  int64_t Version = 0;
  if (!O || !O.map("schema", Version))
    return false;
  if (Version != PlanVersion) {
    P.field("schema").report("written by another version of TPC");
    return false;
  }
  return O.map("process", Out.Process) && O.map("incomplete", Out.Incomplete) &&
         O.map("separated", Out.Separated) && O.map("nodes", Out.Nodes) &&
         O.map("given_up", Out.GivenUp) && O.map("functions", Out.Functions) &&
         O.map("rounds", Out.Rounds) && O.map("reports", Out.Reports) &&
         O.map("names", Out.Names) && O.map("comparisons", Out.Comparisons) &&
         O.map("parameters", Out.Parameters) &&
         O.map("exposing", Out.Exposing) &&
         O.map("not_exposed", Out.NotExposed) &&
         O.map("blind_spots", Out.BlindSpots) && O.map("counts", Out.Counts) &&
         O.map("without_report", Out.WithoutReport) && check(Out, P);
}

/// \p Text with `-0` as a number that is no integer: as one, it has no sign.
static std::string withSigns(StringRef Text) {
  std::string Out;
  Out.reserve(Text.size());
  bool IsText = false;
  for (size_t N = 0; N < Text.size(); ++N) {
    const char C = Text[N];
    Out += C;
    if (IsText && C == '\\' && N + 1 < Text.size())
      Out += Text[++N];
    else if (C == '"')
      IsText = !IsText;
    else if (!IsText && C == '0' && N && Text[N - 1] == '-' &&
             StringRef(" ,]}\n").contains(Text.substr(N + 1, 1)))
      Out += ".0";
  }
  return Out;
}

Expected<Plan> readPlan(StringRef File) {
  auto Buffer = MemoryBuffer::getFile(File);
  if (!Buffer)
    return createFileError(File, Buffer.getError());
  Expected<json::Value> Parsed = json::parse(withSigns((*Buffer)->getBuffer()));
  if (!Parsed)
    return createFileError(File, Parsed.takeError());
  Plan Out;
  Path::Root Root("plan");
  if (!fromJSON(*Parsed, Out, Root))
    return createFileError(File, Root.getError());
  return Out;
}

//===----------------------------------------------------------------------===//
// Writing
//===----------------------------------------------------------------------===//

static json::Value toJSON(const PlannedFunction &F) {
  if (F.Of)
    return json::Object{{"of", *F.Of}, {"in", *F.In}, {"at", *F.At}};
  json::Object O{{"name", F.Name},
                 {"linkage", F.Linkage},
                 {"file", json::fixUTF8(F.File)},
                 {"line", F.Line},
                 {"checksum", F.Checksum}};
  if (!F.Unit.empty())
    O["unit"] = json::fixUTF8(F.Unit);
  return O;
}

static json::Value toJSON(const PlannedValue &V) {
  json::Object O;
  if (V.Argument)
    O["argument"] = *V.Argument;
  if (V.At)
    O["at"] = *V.At;
  if (V.Operand)
    O["operand"] = *V.Operand;
  return O;
}

template <typename T>
static void addSome(json::Object &To, StringRef Name,
                    const std::optional<T> &Value) {
  if (!Value)
    return;
  if constexpr (std::is_integral_v<T>)
    To[Name] = *Value;
  else
    To[Name] = toJSON(*Value);
}

static json::Value toJSON(const PlannedKey &K) {
  return json::Object{{"path", json::fixUTF8(K.Parts.Path)},
                      {"function", json::fixUTF8(K.Parts.Function)},
                      {"line", K.Parts.Line},
                      {"column", K.Parts.Column},
                      {"what", json::fixUTF8(K.Parts.What)},
                      {"ordinal", K.Ordinal}};
}

static json::Value toJSON(const PlannedReport &R) {
  json::Object O{{"function", R.Function},
                 {"key", toJSON(R.Key)},
                 {"before", R.Before},
                 {"result", toJSON(R.Result)},
                 {"compared", toJSON(R.Compared)},
                 {"threshold", toJSON(R.Threshold)},
                 {"outcome", toJSON(R.Outcome)},
                 {"switch", R.Switch},
                 {"signed", R.Signed}};
  addSome(O, "object", R.Object);
  addSome(O, "held", R.Held);
  return O;
}

static json::Value toJSON(const PlannedName &N) {
  json::Object O{{"function", N.Function},
                 {"read", N.Read},
                 {"before", N.Before},
                 {"offset", N.Offset},
                 {"text", json::fixUTF8(N.Text)},
                 {"is_text", N.IsText},
                 {"size", N.Size},
                 {"node_name", N.NodeName}};
  addSome(O, "handle", N.Handle);
  addSome(O, "name", N.Name);
  addSome(O, "object", N.Object);
  return O;
}

static json::Value toJSON(const PlannedEntry &E) {
  json::Object O{{"function", E.Function}, {"info", json::Object(E.Info)}};
  addSome(O, "key", E.Key);
  return O;
}

template <typename T, typename MakerT>
static json::Array listOf(const std::vector<T> &List, MakerT Make) {
  json::Array Out;
  for (const T &Each : List)
    Out.push_back(Make(Each));
  return Out;
}

template <typename T> static json::Array listOf(const std::vector<T> &List) {
  return listOf(List, [](const T &Each) { return toJSON(Each); });
}

static json::Value toJSON(const PlannedComparison &C) {
  json::Value V = toJSON(static_cast<const PlannedEntry &>(C));
  (*V.getAsObject())["instances"] =
      listOf(C.Instances, [](const PlannedInstance &I) {
        return json::Object{{"number", I.Number},
                            {"distance", I.Distance},
                            {"loop_depth", I.LoopDepth},
                            {"reads", I.Reads}};
      });
  return V;
}

static json::Value toJSON(const FunctionCounts &C) {
  json::Array Row{C.Function};
  for (uint64_t Number : C.Of)
    Row.push_back(Number);
  return Row;
}

json::Value toJSON(const Plan &P) {
  return json::Object{
      {"schema", PlanVersion},
      {"process", json::fixUTF8(P.Process)},
      {"tool", json::Object{{"name", "tpc"}, {"version", TPC_VERSION}}},
      {"incomplete", P.Incomplete},
      {"separated", P.Separated},
      {"nodes", P.Nodes},
      {"given_up", P.GivenUp},
      {"functions", listOf(P.Functions)},
      {"rounds", listOf(P.Rounds,
                        [](const std::vector<uint64_t> &Round) {
                          return json::Array(Round);
                        })},
      {"reports", listOf(P.Reports)},
      {"names", listOf(P.Names)},
      {"comparisons", listOf(P.Comparisons)},
      {"parameters", listOf(P.Parameters)},
      {"exposing", listOf(P.Exposing)},
      {"not_exposed", listOf(P.NotExposed)},
      {"blind_spots", listOf(P.BlindSpots)},
      {"counts", listOf(P.Counts)},
      {"without_report", P.WithoutReport}};
}

} // namespace tpc
