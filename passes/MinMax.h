//===- MinMax.h - The smaller or the larger one of two values -------------===//
//
// std::min, std::max and std::clamp, inlined, and what people write instead: a
// value that control flow merges from two others, as a comparison of the same
// two decides.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_MINMAX_H
#define TPC_MINMAX_H

#include "ClassObjectAccess.h"

namespace tpc {

struct Choice {
  bool Largest;    ///< the larger one; else the smaller one
  double Constant; ///< one of the two; the other is a value of the program
};

/// How \p Merge (a phi, a select, or a load through a pointer that is one)
/// chooses between a constant and another value; none where it does not.
std::optional<Choice> choiceOf(const llvm::Instruction &Merge,
                               const AccessResult &Access);

/// True where \p A and \p B surely point to the same variable.
bool isSameVariable(const llvm::Value *A, const llvm::Value *B,
                    const AccessResult &Access);

} // namespace tpc

#endif // TPC_MINMAX_H
