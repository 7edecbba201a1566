//===- Idioms.h - Code patterns of several instructions -------------------===//
//
// Recognises std::min, std::max and std::clamp after inlining, and the code
// that people write instead: control flow merges two values, and a comparison
// of the same two chooses. Also squares whose factors are computed twice, and
// values that accumulate.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_IDIOMS_H
#define TPC_IDIOMS_H

#include "llvm/ADT/SmallVector.h"
#include "llvm/IR/Instructions.h"

#include <optional>

namespace tpc {

struct Choice {
  bool Largest;    ///< the larger of the two; otherwise the smaller
  double Constant; ///< one of the two; the other is computed by the program
};

/// How \p Merge (a phi, a select, or a load through a pointer that is one)
/// chooses between a constant and another value; none if it does not.
std::optional<Choice> choiceOf(const llvm::Instruction &Merge);

/// One of the values of which the smallest or largest is taken.
struct Limited {
  const llvm::Value *Side;     ///< the value, or the pointer that leads to it
  const llvm::Value *Compared; ///< the value, as it is compared
};

/// The values of which \p Merge (see choiceOf) takes the smaller or the larger,
/// all of them if it is a clamp; empty if it does something else.
llvm::SmallVector<Limited, 3> limitedBy(const llvm::Instruction &Merge);
/// The same by hand: the value with which what \p Store stores was compared, if
/// it is only stored if it is smaller, or larger; null if that is not so.
const llvm::Value *limitedBy(const llvm::StoreInst &Store);

/// True if \p A and \p B point to the same variable of the same object, judged
/// by how they are computed. A pointer that is read twice counts as the same
/// pointer.
bool isSameVariable(const llvm::Value *A, const llvm::Value *B);

/// True if \p V is computed from \p Source, or from the variable that it loads,
/// in one function.
bool isComputedFrom(const llvm::Value *V, const llvm::Value *Source);

/// True if \p Store moves a variable on: what it stores is computed from what
/// the variable held before.
bool isMovedOn(const llvm::StoreInst &Store);

/// True if \p Merge, a phi of a loop, is moved on by arithmetic in each round:
/// a sampled or accumulated value, whatever it began with. Counting a whole
/// number down to zero by constants is not meant: its first value decides how
/// often the loop runs.
bool isStepped(const llvm::PHINode &Merge);

/// Whether \p I multiplies a value with itself, even if it is computed twice:
/// 1, or -1 if one factor is negated; otherwise 0.
int squareOf(const llvm::Instruction &I);

} // namespace tpc

#endif // TPC_IDIOMS_H
