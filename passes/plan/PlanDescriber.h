//===- PlanDescriber.h - The static information of an unanalysed unit -----===//
#ifndef TPC_PLANDESCRIBER_H
#define TPC_PLANDESCRIBER_H

#include "output/StaticInfo.h"
#include "plan/PlanFunctions.h"

namespace tpc {

/// A plan and its functions in the link unit.
struct PlacedPlan {
  Plan Of;
  std::optional<PlanFunctions> Functions;

  /// True if something that it says lies in the link unit.
  bool givesSomething() const;
};

/// What \p Plans say of the link unit.
UnitInfo describePlanned(llvm::ArrayRef<std::unique_ptr<PlacedPlan>> Plans,
                         const Options &Opts);

} // namespace tpc

#endif // TPC_PLANDESCRIBER_H
