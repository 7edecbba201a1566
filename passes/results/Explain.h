//===- Explain.h - Why a comparison is reported ---------------------------===//
//
// The way of a parameter's value from the read to the comparison, as
// ParamUsageFinder went it, and from the predicate to the nearest exposing
// statement, as BackwardPropagate did, in steps of the source: what happens on
// one line is one step, what happens inside a library is left out.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_EXPLAIN_H
#define TPC_EXPLAIN_H

#include "calls/SimpleCallGraph.h"
#include "params/ParamCallFinder.h"
#include "results/GatherResults.h"
#include "results/Wording.h"

namespace tpc {

struct PathStep {
  /// The later one says more: it stands for a line with several.
  enum KindTy {
    Load,    ///< a variable is read
    Compute, ///< arithmetic
    Store,   ///< a variable is written
    Pass,    ///< an argument of a call
    Return,
    Call,    ///< a function that holds the next step is called
    Value,   ///< a predicate that chooses a value
    Control, ///< a predicate that guards the next step
    Decide,  ///< the comparison's own predicate
    Compare,
    Read,
    Expose,
    Omitted, ///< stands for steps that are too many
  };
  KindTy Kind;
  const llvm::DILocation *Loc; ///< null where it is not known
  std::string What;            ///< in a few words

  llvm::StringRef kindName() const;
};

class Explainer {
public:
  Explainer(const ParameterUsage &Usage, const SliceResult &Slice,
            const ParamCallFinder::Result &Reads,
            const ExternCallFinder::Result &Exposing,
            const CallGraphResult &Calls, Wording &Words)
      : Usage(Usage), Slice(Slice), Reads(Reads), Exposing(Exposing),
        Calls(Calls), Words(Words) {}

  /// From the first read of \p C to its nearest exposing statement, at most
  /// \p Most steps before the predicate and behind it.
  std::vector<PathStep> path(const Comparison &C, size_t Most);
  /// How many these are in a unit with \p NumComparisons.
  static size_t stepsFor(size_t NumComparisons);

private:
  using Steps = std::vector<PathStep>;
  Steps forward(const Comparison &C);
  Steps backward(const Comparison &C);
  void hop(const Hop &H, const Comparison &C, bool IsOutcome, Steps &Out);
  void dependence(const SliceStep &S, const SliceStep &Next, bool IsFirst,
                  Steps &Out);
  void byReference(const llvm::Value *Pointer, const llvm::LoadInst &Load,
                   Steps &Out);
  std::string compared(const Comparison &C) const;
  void add(Steps &Out, PathStep::KindTy Kind, const llvm::Instruction &I,
           std::string What);

  const ParameterUsage &Usage;
  const SliceResult &Slice;
  const ParamCallFinder::Result &Reads;
  const ExternCallFinder::Result &Exposing;
  const CallGraphResult &Calls;
  Wording &Words;
};

} // namespace tpc

#endif // TPC_EXPLAIN_H
