//===- ApplyPlans.h - Inserts what other links found ----------------------===//
//
// Instead of an analysis, a link can take the findings of the processes that
// its unit is part of. Of each plan, it takes what lies in functions that the
// unit defines; of several plans, the union, each place once.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_APPLYPLANS_H
#define TPC_APPLYPLANS_H

#include "output/Findings.h"

namespace tpc {

class Rules;

/// Collects in \p Out what the plans of \p Opts say of \p M. Warns of plans
/// that cannot be used; fails if none can. \p M changes if functions must be
/// copied for single calls.
void applyPlans(llvm::Module &M, const Rules &Tables, const Options &Opts,
                Findings &Out);

} // namespace tpc

#endif // TPC_APPLYPLANS_H
