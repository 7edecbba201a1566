//===- PlanWriter.h - Writes what was found as a plan ---------------------===//
#ifndef TPC_PLANWRITER_H
#define TPC_PLANWRITER_H

#include "output/Findings.h"

namespace tpc {

/// Of each report and name in the findings, in the same order, and of each
/// comparison without a report: what it is about.
struct PlannedFindings {
  std::vector<const Comparison *> Reported, WithoutReport;
  std::vector<const ParameterRead *> Named;
};

/// Writes to `-tpc-plan-out` what the analysis of \p Analysed found and
/// \p Found will insert into \p M, as \p Of says what it is about. Warns if the
/// file cannot be written.
void writePlan(llvm::Module &M, AnalysedModule &Analysed,
               llvm::ModuleAnalysisManager &AM, const Options &Opts,
               const Findings &Found, const PlannedFindings &Of);

} // namespace tpc

#endif // TPC_PLANWRITER_H
