//===- Throws.h - Which calls throw, as the source says -------------------===//
//
// A `throw` in the user's own code leaves its function, and those that call it,
// until a handler takes it. What stands behind such a call is reached only if
// nothing is thrown: it depends on the call as it would on a predicate.
//
// Functions without a body are not taken to throw, nor is a library's own check
// (std::vector::at): nobody who reads the source means those.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_THROWS_H
#define TPC_THROWS_H

#include "calls/SimpleCallGraph.h"

#include "llvm/ADT/SetVector.h"
#include "llvm/IR/Instructions.h"

#include <optional>

namespace tpc {

/// The type of what is thrown: its `_ZTI` object; null where it is not known,
/// since a handler throws on what it has.
using ThrownType = const llvm::GlobalVariable *;

/// True where a handler for \p Handler (null: for all) takes a \p Thrown; none
/// where the unit does not say.
std::optional<bool> isTakenBy(ThrownType Thrown, const llvm::Constant *Handler);

/// True for `throw X;` and `throw;`, wherever they stand.
bool isThrow(const llvm::Instruction &I);

class ThrowsResult {
public:
  using Types = llvm::SmallVector<ThrownType, 2>;

  /// What \p I throws: a `throw` of the user's, or a call that leads to one.
  llvm::ArrayRef<ThrownType> thrownBy(const llvm::Instruction &I) const;
  /// The instructions by which exceptions leave \p F.
  llvm::ArrayRef<llvm::CallBase *> leaving(const llvm::Function *F) const;
  /// True where \p Call is one of those of its function.
  bool leaves(const llvm::CallBase &Call) const;

private:
  friend class Throws;
  llvm::DenseMap<const llvm::Instruction *, Types> ByCall;
  llvm::DenseMap<const llvm::Function *,
                 llvm::SmallSetVector<llvm::CallBase *, 2>>
      Leaving;
};

class Throws : public llvm::AnalysisInfoMixin<Throws> {
public:
  using Result = ThrowsResult;
  Result run(llvm::Module &M, llvm::ModuleAnalysisManager &AM);

private:
  friend llvm::AnalysisInfoMixin<Throws>;
  static llvm::AnalysisKey Key;
};

} // namespace tpc

#endif // TPC_THROWS_H
