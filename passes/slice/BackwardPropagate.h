//===- BackwardPropagate.h - What the exposing statements depend on -------===//
//
// Thesis A.10 and its algorithm 3: the slice, computed in rounds from all
// exposing statements backwards over control and data dependence. The distance
// of a predicate is the round in which it first controls an instruction of the
// slice.
//
// Control: the predicates that control the block of an instruction, and the
// calls of its function if it runs whenever the function does. A call that may
// throw in user code is like a predicate: it enters the next round, and what
// throws in the called function enters the round after that.
//
// Data: from instructions to operands, from loads to the writes of the
// variable, from arguments to the calls, from results to the callee's returns,
// from phis to the predicates that choose; for an exposing statement,
// everything that can be reached from its arguments. A call that is in the
// slice only for what it calls, not for its result, adds no operands.
//
// What enters for the result of a call runs if that call does: other calls of
// the function do not enter for it. Otherwise calls and returns are not
// matched: calls are distinguished by their callee alone, as in the thesis.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_BACKWARDPROPAGATE_H
#define TPC_BACKWARDPROPAGATE_H

#include "llvm/ADT/DenseMap.h"
#include "llvm/IR/InstrTypes.h"
#include "llvm/IR/PassManager.h"

#include <optional>

namespace tpc {

/// An element of the slice, and the element nearer to the exposing statement
/// that added it.
struct SliceStep {
  enum WhyTy : unsigned char {
    Exposes,  ///< it is the exposing statement
    Controls, ///< decides whether the next one runs
    Chooses,  ///< decides which value the next one has
    Calls,    ///< calls the function of the next one
    Mentions, ///< hands that function on, so that somebody else calls it
    Gives,    ///< the next one computes with its result
    Writes,   ///< writes what the next one reads
    Returns,  ///< returns the result of the next one, a call
    Passes,   ///< passes an argument to the function of the next one
    Throws,   ///< throws, or does not catch, what the next one, a call, throws
  };
  llvm::Instruction *I;
  unsigned Next; ///< number of the step that added it
  WhyTy Why;
};

/// How a predicate entered the slice.
struct SliceEntry {
  unsigned Distance;
  unsigned Exposing; ///< number of the nearest exposing statement
  unsigned Step;     ///< number of the predicate's own step
};

class SliceResult {
public:
  /// None if no exposing statement depends on \p Predicate.
  std::optional<SliceEntry> lookup(const llvm::Instruction *Predicate) const;
  /// How the outcome of \p Compare entered the slice as a value, such as that
  /// of a message that is published; none if it did not.
  std::optional<SliceEntry> shown(const llvm::CmpInst *Compare) const;
  unsigned numPredicates() const { return Predicates.size(); }
  /// The predicates that an exposing statement depends on, in no order.
  auto predicates() const { return llvm::make_first_range(Predicates); }
  /// The path from a predicate to its nearest exposing statement: the one that
  /// determined its distance.
  llvm::SmallVector<SliceStep, 16> pathOf(const SliceEntry &E) const;

private:
  friend class Slicer;
  llvm::DenseMap<const llvm::Instruction *, SliceEntry> Predicates, Shown;
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
