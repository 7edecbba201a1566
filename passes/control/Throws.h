//===- Throws.h - Which calls throw, according to the source --------------===//
//
// A `throw` in user code leaves its function, and those that call it, until a
// handler catches it. Code behind such a call is reached only if nothing is
// thrown: it depends on the call as on a predicate.
//
// Functions without a body do not count as throwing, and neither do checks
// inside a library (std::vector::at): a reader of the source does not think of
// them.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_THROWS_H
#define TPC_THROWS_H

#include "calls/SimpleCallGraph.h"

#include "llvm/ADT/SetVector.h"
#include "llvm/IR/Instructions.h"

#include <optional>

namespace tpc {

/// The type that is thrown: its `_ZTI` object; null if it is not known, since a
/// handler rethrows what it caught.
using ThrownType = const llvm::GlobalVariable *;

/// True if a handler for \p Handler (null: for all types) catches a \p Thrown;
/// none if the link unit does not say.
std::optional<bool> isTakenBy(ThrownType Thrown, const llvm::Constant *Handler);

/// True for `throw X;` and `throw;` in any code.
bool isThrow(const llvm::Instruction &I);

class ThrowsResult {
public:
  using Types = llvm::SmallVector<ThrownType, 2>;

  /// The types that \p I throws: \p I is a `throw` in user code, or a call that
  /// leads to one.
  llvm::ArrayRef<ThrownType> thrownBy(const llvm::Instruction &I) const;
  /// The instructions by which exceptions leave \p F.
  llvm::ArrayRef<llvm::CallBase *> leaving(const llvm::Function *F) const;
  /// True if an exception can leave its function at \p Call.
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
