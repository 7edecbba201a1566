//===- Findings.h - What is known of a link unit --------------------------===//
#ifndef TPC_FINDINGS_H
#define TPC_FINDINGS_H

#include "instrument/InstrumentBranches.h"
#include "instrument/InstrumentReads.h"
#include "output/StaticInfo.h"

#include <vector>

namespace tpc {

/// What is to be inserted into a link unit and written about it: the result of
/// its analysis, or of that of the processes that it is part of.
struct Findings {
  UnitInfo Unit;
  std::vector<Report> Reports;
  std::vector<NamedRead> Names;
  bool Nodes = false;           ///< nodes are reported
  unsigned NotInstrumented = 0; ///< comparisons that have no report
  std::string Failure;
  /// Why the analysis has not found everything that it could; empty if it has.
  std::string Incomplete;
  /// The functions that reports need were copied or inlined.
  bool IsChanged = false;
};

} // namespace tpc

#endif // TPC_FINDINGS_H
