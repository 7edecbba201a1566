//===- FunctionPointers.h - Where calls through pointers go ---------------===//
//
// Follows the callee of an indirect call back to the functions whose address it
// can hold: through values, arguments, results and memory. Memory is
// distinguished by field, not by object (Heintze and Tardieu, "Ultra-fast
// aliasing analysis using CLA", PLDI 2001): all objects of a class share a
// field, so copying an object needs no work. std::function, boost::function and
// the results of bind keep their targets in such fields.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_FUNCTIONPOINTERS_H
#define TPC_FUNCTIONPOINTERS_H

#include "llvm/ADT/DenseMap.h"
#include "llvm/ADT/DenseSet.h"
#include "llvm/ADT/STLFunctionalExtras.h"
#include "llvm/ADT/SetVector.h"
#include "llvm/ADT/SmallVector.h"
#include "llvm/IR/InstrTypes.h"
#include "llvm/IR/Module.h"

namespace tpc {

class FunctionPointers {
public:
  using CallersTy = llvm::function_ref<llvm::ArrayRef<llvm::CallBase *>(
      const llvm::Function *)>;

  explicit FunctionPointers(llvm::Module &M);

  /// The functions that \p Call can enter, according to stored addresses and
  /// types; \p Callers holds the calls resolved so far. Empty if no target is
  /// known, or too many are.
  llvm::SmallVector<llvm::Function *, 2> targets(const llvm::CallBase &Call,
                                                 CallersTy Callers);

private:
  /// A piece of memory: field Index of a class or, with NoIndex, what the
  /// pointer Base (a global, a local, an argument...) leads to.
  using Cell = std::pair<const void *, unsigned>;
  static constexpr unsigned NoIndex = ~0U;
  struct Search;

  static Cell findCell(const llvm::Value *Pointer);
  Cell cellOf(const llvm::Value *Pointer);
  void addInitializer(const llvm::Constant *C, Cell Where);

  /// What findCell() found.
  llvm::DenseMap<const llvm::Value *, Cell> CellOf;
  /// A search that comes to one of these visits too many places.
  llvm::DenseSet<Cell> TooFar;
  llvm::DenseMap<Cell, llvm::SmallVector<const llvm::Value *, 2>> Stored;
  llvm::DenseMap<Cell, llvm::SmallSetVector<Cell, 1>> CopiedFrom;
};

} // namespace tpc

#endif // TPC_FUNCTIONPOINTERS_H
