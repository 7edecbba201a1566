//===- GatherResults.h - The threshold predicate comparisons --------------===//
//
// Thesis A.12: the comparisons that both ParamUsageFinder and BackwardPropagate
// found, with the label of each. ParamUsageFinder and ConstantFinder decide
// what is a threshold; docs/explanation/architecture.md#the-passes lists what a
// new kind needs.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_GATHERRESULTS_H
#define TPC_GATHERRESULTS_H

#include "params/ParamCallFinder.h"
#include "params/ParamUsageFinder.h"
#include "slice/BackwardPropagate.h"

#include "llvm/ADT/SetVector.h"

namespace tpc {

struct Comparison {
  enum TypeTy { Parameter, Flag, Derived, Constant };
  TypeTy Type;
  llvm::CmpInst *Compare; ///< null for a flag and for text
  unsigned Threshold = 0; ///< the operand of Compare that is the threshold
  llvm::Value *FlagValue; ///< the value that decides if there is no Compare
  llvm::StringRef TextRelation; ///< see ParameterComparison
  llvm::Instruction *Predicate; ///< the nearest predicate that it decides
  bool Direct;                  ///< see Decision
  bool IsOperand;               ///< see ParameterComparison
  Transform How;
  llvm::SmallVector<unsigned, 1> Reads; ///< all with the same parameter name
  /// For a constant: the name of its variable, or the number.
  std::string ConstantName;
  SliceEntry Slice;
  unsigned Way; ///< see Decision
  unsigned OtherThresholds = 0;
  std::string Key; ///< stays the same in the next build
  /// Its number among those at one place with one parameter.
  unsigned Ordinal = 0;
  /// The place in user code. A comparison inside std::min, for example, has the
  /// place of the call of std::min.
  const llvm::DILocation *Where;

  /// The instruction at that place.
  const llvm::Instruction &place() const {
    if (Compare)
      return *llvm::cast<llvm::Instruction>(Compare);
    return IsOperand || !TextRelation.empty()
               ? *llvm::cast<llvm::Instruction>(FlagValue)
               : *Predicate;
  }
  llvm::StringRef typeName() const;
  /// The operator with the threshold on the right, or `flag`.
  llvm::StringRef relation() const;
};

/// The parameter or constant that \p C has in its key.
std::string whatOf(const Comparison &C, const ParamCallFinder::Result &Reads);

/// A comparison with a parameter that is not reported, and the reason.
struct NotReported {
  enum WhyTy {
    NotExposed,
    OutsideSources,
    WithoutDebugInfo,
    Measured, ///< it is compared with another threshold
  };
  const ParameterComparison *Compared;
  WhyTy Why;
};

struct GatheredResults {
  /// In the order of the reads, and for one read of the forward search.
  std::vector<Comparison> Comparisons;
  /// Comparisons with constants, in the order of the program. None of them is
  /// in Comparisons.
  std::vector<Comparison> Constants;
  unsigned OutsideSources = 0; ///< comparisons in code that is not user code
  /// Functions that compare a parameter which only some of their calls pass;
  /// the other calls compare something else.
  llvm::SmallSetVector<llvm::Function *, 4> Shared;
  unsigned WithoutDebugInfo = 0; ///< comparisons whose place is not known
  std::vector<NotReported> Others;
};

class GatherResults : public llvm::AnalysisInfoMixin<GatherResults> {
public:
  using Result = GatheredResults;
  Result run(llvm::Module &M, llvm::ModuleAnalysisManager &AM);

private:
  friend llvm::AnalysisInfoMixin<GatherResults>;
  static llvm::AnalysisKey Key;
};

/// `print<tpc-gather-results>`
class GatherResultsPrinter : public llvm::PassInfoMixin<GatherResultsPrinter> {
public:
  explicit GatherResultsPrinter(llvm::raw_ostream &OS) : OS(OS) {}
  llvm::PreservedAnalyses run(llvm::Module &M, llvm::ModuleAnalysisManager &AM);
  static bool isRequired() { return true; }

private:
  llvm::raw_ostream &OS;
};

} // namespace tpc

#endif // TPC_GATHERRESULTS_H
