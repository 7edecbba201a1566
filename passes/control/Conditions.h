//===- Conditions.h - Which predicates belong to one condition ------------===//
//
// `if (a < x && b < y)` is two predicates and one condition.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_CONDITIONS_H
#define TPC_CONDITIONS_H

#include "llvm/ADT/ArrayRef.h"
#include "llvm/ADT/EquivalenceClasses.h"
#include "llvm/IR/Instruction.h"

namespace tpc {

class Conditions {
public:
  /// The conditions of \p Predicates, and of what belongs to them.
  explicit Conditions(llvm::ArrayRef<const llvm::Instruction *> Predicates);

  /// One predicate that stands for the condition of \p Predicate, one of those.
  const llvm::Instruction *of(const llvm::Instruction &Predicate) const {
    return Classes.getLeaderValue(&Predicate);
  }

private:
  llvm::EquivalenceClasses<const llvm::Instruction *> Classes;
};

} // namespace tpc

#endif // TPC_CONDITIONS_H
