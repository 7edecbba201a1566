//===- Explain.h - Why a comparison is reported ---------------------------===//
//
// The path of a parameter's value from the read to the comparison, which
// ParamUsageFinder found, and the path from the predicate to the nearest
// exposing statement, which BackwardPropagate found. Steps are those of the
// source: everything on one line is one step, and steps inside a library are
// left out.
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
  /// Of several steps on one line, the kind that comes last in this list is
  /// shown.
  enum KindTy {
    Load,    ///< a variable is read
    Compute, ///< arithmetic
    Store,   ///< a variable is written
    Pass,    ///< an argument of a call
    Return,
    Call,    ///< a function that contains the next step is called
    Value,   ///< a predicate that chooses a value
    Control, ///< a predicate that guards the next step
    Decide,  ///< the comparison's own predicate
    Compare,
    Read,
    Expose,
    Omitted, ///< stands for steps left out because there are too many
  };
  KindTy Kind;
  const llvm::DILocation *Loc; ///< null if it is not known
  std::string What;            ///< a short description
  /// The link unit of a process that has the line; empty if not known.
  llvm::StringRef Unit = "";

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

  /// From the first read of \p C to its nearest exposing statement, with at
  /// most \p Most steps on each side of the predicate.
  std::vector<PathStep> path(const Comparison &C, size_t Most);
  /// The value for Most in a link unit with \p NumComparisons.
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
  llvm::StringRef unitOf(const llvm::Instruction &I,
                         const llvm::DILocation *Loc);

  const ParameterUsage &Usage;
  const SliceResult &Slice;
  const ParamCallFinder::Result &Reads;
  const ExternCallFinder::Result &Exposing;
  const CallGraphResult &Calls;
  Wording &Words;
  /// The functions of a process by what the debug information knows them as.
  llvm::DenseMap<const llvm::DISubprogram *, const llvm::Function *> Functions;
};

} // namespace tpc

#endif // TPC_EXPLAIN_H
