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
  /// Groups \p Predicates into conditions.
  explicit Conditions(llvm::ArrayRef<const llvm::Instruction *> Predicates);

  /// The predicate that represents the condition of \p Predicate, which must be
  /// one of those given.
  const llvm::Instruction *of(const llvm::Instruction &Predicate) const {
    return Classes.getLeaderValue(&Predicate);
  }

private:
  llvm::EquivalenceClasses<const llvm::Instruction *> Classes;
};

} // namespace tpc

#endif // TPC_CONDITIONS_H
