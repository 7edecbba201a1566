//===- Sides.h - Which operand is the threshold ---------------------------===//
//
// Both operands of a comparison can hold the value of a parameter: `if
// (out.data < lower_)` after `out.data = upper_`. The threshold is the operand
// that is always configured, as constants are. An operand that is a measured
// value on another path is the one that is compared with it.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_SIDES_H
#define TPC_SIDES_H

#include "params/Configured.h"
#include "params/ParamUsageFinder.h"

#include "llvm/ADT/SmallPtrSet.h"

namespace tpc {

class Sides {
public:
  /// Considers only what \p IsExposed holds for in \p Usage: another side that
  /// is not reported does not make this side less of a threshold.
  Sides(const ParameterUsage &Usage, const ParamCallFinder::Result &Reads,
        const CallGraphResult &Calls, PointsTo &Pointers, VisibleWrites &Writes,
        llvm::function_ref<bool(const ParameterComparison &)> IsExposed);

  /// True if the other operand of \p C, in what decides \p Predicate, is the
  /// same parameter by a shorter path and may be the threshold. Calls of one
  /// function may differ in this.
  bool isOtherWay(const ParameterComparison &C,
                  const llvm::Instruction &Predicate);
  /// True if \p C, in what decides \p Predicate, is about the operand that is
  /// not the threshold: it can be something else than a parameter or constant,
  /// and the other operand cannot.
  bool isMeasured(const ParameterComparison &C,
                  const llvm::Instruction &Predicate);

private:
  bool isSameParameter(unsigned Read, unsigned Other) const;
  size_t lengthOf(const ParameterComparison &C) const;

  const ParameterUsage &Usage;
  const ParamCallFinder::Result &Reads;
  Configured Values;
  /// The comparisons whose operands both hold the value of a parameter.
  llvm::DenseMap<const llvm::CmpInst *,
                 llvm::SmallVector<const ParameterComparison *, 4>>
      ByCompare;
};

} // namespace tpc

#endif // TPC_SIDES_H
