//===- Plan.h - Findings that another link inserts ------------------------===//
//
// What the analysis of a program found, in terms of the program before anything
// was inserted: docs/reference/formats.md. Functions have numbers; values are
// arguments, instructions (by their numbers) and their operands.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_PLAN_H
#define TPC_PLAN_H

#include "results/Keys.h"

#include "llvm/Support/Error.h"
#include "llvm/Support/JSON.h"

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace tpc {

inline constexpr int PlanVersion = 1;

/// A function of the program, or (with Of, In and At) the copy of function Of
/// that serves the call At in function In.
struct PlannedFunction {
  std::string Name, Linkage, File; ///< of none that is copied
  std::string Unit; ///< the only link unit that has it, if that is known
  uint64_t Line = 0;
  std::string Checksum;
  std::optional<uint64_t> Of, In, At;
};

/// An argument, an instruction or one of its operands.
struct PlannedValue {
  std::optional<uint64_t> Argument, At, Operand;
};

struct PlannedKey {
  KeyParts Parts;
  uint64_t Ordinal = 0;
};

struct PlannedReport {
  uint64_t Function = 0;
  PlannedKey Key;
  uint64_t Before = 0;
  PlannedValue Result, Compared, Threshold, Outcome;
  std::optional<PlannedValue> Object;
  std::optional<uint64_t> Held; ///< the call that compares two objects
  bool Switch = false, Signed = true;
};

/// The name of a read that the running node reports (InstrumentReads.h).
struct PlannedName {
  uint64_t Function = 0, Read = 0; ///< Read: number of the parameter
  uint64_t Before = 0, Offset = 0, Size = 0;
  std::optional<PlannedValue> Handle, Name, Object;
  std::string Text, NodeName;
  bool IsText = false;
};

/// An entry of the static information, with absolute files and no key.
struct PlannedEntry {
  uint64_t Function = 0;
  std::optional<PlannedKey> Key;
  llvm::json::Object Info;
};

/// One of the comparisons that share a key.
struct PlannedInstance {
  uint64_t Number, Distance, LoopDepth;
  std::vector<uint64_t> Reads; ///< numbers of parameters
};

/// The comparisons in one function that share a key. Info is that of the
/// nearest one.
struct PlannedComparison : PlannedEntry {
  std::vector<PlannedInstance> Instances;
};

/// What the analysis counted in one function.
struct FunctionCounts {
  enum {
    Defined, ///< 1 if it is analysed
    Predicates,
    InSlice,
    IndirectCalls,
    Lost,
    NoDebugInfo,
    Outside,
    Size
  };
  uint64_t Function = 0;
  std::array<uint64_t, Size> Of{};
};

struct Plan {
  std::string Process;
  std::string Incomplete; ///< why the analysis did not find everything
  bool Separated = false; ///< functions are inlined and copied as below
  bool Nodes = false;     ///< nodes are reported
  uint64_t GivenUp = 0;
  std::vector<PlannedFunction> Functions;
  std::vector<std::vector<uint64_t>> Rounds; ///< the functions that are copied
  std::vector<PlannedReport> Reports;
  std::vector<PlannedName> Names;
  std::vector<PlannedComparison> Comparisons;
  std::vector<PlannedEntry> Parameters, Exposing, NotExposed, BlindSpots;
  std::vector<FunctionCounts> Counts;
  /// For each comparison that has no report, its function.
  std::vector<uint64_t> WithoutReport;

  /// The function that \p Number is, or is a copy of.
  const PlannedFunction &base(uint64_t Number) const;
  uint64_t baseNumber(uint64_t Number) const;
};

/// The plan in the file \p Path. The error says where it is broken.
llvm::Expected<Plan> readPlan(llvm::StringRef Path);

llvm::json::Value toJSON(const Plan &P);

} // namespace tpc

#endif // TPC_PLAN_H
