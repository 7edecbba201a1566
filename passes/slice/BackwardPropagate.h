//===- BackwardPropagate.h - What the exposing statements depend on -------===//
//
// Thesis A.10 and its algorithm 3: the slice, from all exposing statements
// backwards over control and data dependence, by rounds. The round in which a
// predicate first controls an instruction of the slice is its distance.
//
// Control: the predicates that control an instruction's block, and the calls
// of its function where it runs whenever the function does. A call that
// may throw, as the user wrote it, is like a predicate: it enters the next
// round, and what throws in the function that it calls the one after that.
// Data: operands; loads to the writes of the variable; arguments to the calls;
// results to the callee's returns; a value that control flow merges to the
// predicates that choose it; for an exposing statement all that is reachable
// from its arguments. A call that is in the slice only because of what it
// calls, not because of its result, brings in no operands.
//
// The way in and out of a function is not matched: calls are told apart by
// their callee alone, as in the thesis.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_BACKWARDPROPAGATE_H
#define TPC_BACKWARDPROPAGATE_H

#include "llvm/ADT/DenseMap.h"
#include "llvm/IR/Instruction.h"
#include "llvm/IR/PassManager.h"

#include <optional>

namespace tpc {

/// One thing of the slice, and the thing nearer to the exposing statement that
/// brought it in.
struct SliceStep {
  enum WhyTy : unsigned char {
    Exposes,  ///< it is the exposing statement
    Controls, ///< decides whether the next one runs
    Chooses,  ///< decides which value the next one has
    Calls,    ///< calls the function of the next one
    Mentions, ///< hands that function on, so that somebody else calls it
    Gives,    ///< the next one computes with its value
    Writes,   ///< writes what the next one reads
    Returns,  ///< returns what the next one, a call, gives
    Passes,   ///< hands the function of the next one an argument
    Throws,   ///< throws, or lets through, what the next one, a call, throws
  };
  llvm::Instruction *I;
  unsigned Next; ///< number of the step that brought it in
  WhyTy Why;
};

/// How a predicate got into the slice.
struct SliceEntry {
  unsigned Distance;
  unsigned Exposing; ///< number of the nearest exposing statement
  unsigned Step;     ///< number of the predicate's own step
};

class SliceResult {
public:
  /// None where no exposing statement depends on \p Predicate.
  std::optional<SliceEntry> lookup(const llvm::Instruction *Predicate) const;
  unsigned numPredicates() const { return Predicates.size(); }
  /// The way from a predicate to its nearest exposing statement: the one by
  /// which its distance came about.
  llvm::SmallVector<SliceStep, 16> pathOf(const SliceEntry &E) const;

private:
  friend class Slicer;
  llvm::DenseMap<const llvm::Instruction *, SliceEntry> Predicates;
  std::vector<SliceStep> Steps;
};

class BackwardPropagate : public llvm::AnalysisInfoMixin<BackwardPropagate> {
public:
  using Result = SliceResult;
  Result run(llvm::Module &M, llvm::ModuleAnalysisManager &AM);

private:
  friend llvm::AnalysisInfoMixin<BackwardPropagate>;
  static llvm::AnalysisKey Key;
};

/// `print<tpc-backward-propagate>`
class BackwardPropagatePrinter
    : public llvm::PassInfoMixin<BackwardPropagatePrinter> {
public:
  explicit BackwardPropagatePrinter(llvm::raw_ostream &OS) : OS(OS) {}
  llvm::PreservedAnalyses run(llvm::Module &M, llvm::ModuleAnalysisManager &AM);
  static bool isRequired() { return true; }

private:
  llvm::raw_ostream &OS;
};

} // namespace tpc

#endif // TPC_BACKWARDPROPAGATE_H
