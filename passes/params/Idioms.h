//===- Idioms.h - What takes several instructions to say ------------------===//
//
// std::min, std::max and std::clamp, inlined, and what people write instead: a
// value that control flow merges from two others, as a comparison of the same
// two decides. And squares, whose factors are computed twice.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_IDIOMS_H
#define TPC_IDIOMS_H

#include "llvm/IR/Instructions.h"

#include <optional>

namespace tpc {

struct Choice {
  bool Largest;    ///< the larger one; else the smaller one
  double Constant; ///< one of the two; the other is a value of the program
};

/// How \p Merge (a phi, a select, or a load through a pointer that is one)
/// chooses between a constant and another value; none where it does not.
std::optional<Choice> choiceOf(const llvm::Instruction &Merge);

/// True where \p A and \p B are pointers to the same variable of the same
/// object, by the way that they are computed. A pointer that is read twice is
/// taken for the same one.
bool isSameVariable(const llvm::Value *A, const llvm::Value *B);

/// Whether \p I multiplies a value with itself, be it that it is computed
/// twice: 1, or -1 where one of the two is negated; else 0.
int squareOf(const llvm::Instruction &I);

} // namespace tpc

#endif // TPC_IDIOMS_H
