//===- GatherResults.h - The threshold predicate comparisons --------------===//
//
// Thesis A.12: what ParamUsageFinder and BackwardPropagate agree on, and the
// label of each. What is a threshold is decided in ParamUsageFinder and
// ConstantFinder; docs/explanation/architecture.md#the-passes says what else
// another kind needs.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_GATHERRESULTS_H
#define TPC_GATHERRESULTS_H

#include "params/ParamUsageFinder.h"
#include "slice/BackwardPropagate.h"

#include "llvm/ADT/SetVector.h"

namespace tpc {

struct Comparison {
  enum TypeTy { Parameter, Flag, Derived, Constant };
  TypeTy Type;
  llvm::CmpInst *Compare;       ///< null for a flag and for text
  unsigned Threshold = 0;       ///< operand of Compare that is the threshold
  llvm::Value *FlagValue;       ///< what decides where there is no Compare
  llvm::StringRef TextRelation; ///< see ParameterComparison
  llvm::Instruction *Predicate; ///< the nearest one that it decides
  bool Direct;                  ///< see Decision
  bool IsOperand;               ///< see ParameterComparison
  Transform How;
  llvm::SmallVector<unsigned, 1> Reads; ///< all of one parameter name
  std::string ConstantName; ///< of a constant: its variable or its number
  SliceEntry Slice;
  unsigned Way; ///< see Decision
  unsigned OtherThresholds = 0;
  std::string Key; ///< survives a rebuild
  /// Where it stands in the user's own sources: for a comparison that is in
  /// std::min, say, the call of that.
  const llvm::DILocation *Where;

  /// The instruction that stands there.
  const llvm::Instruction &place() const {
    if (Compare)
      return *llvm::cast<llvm::Instruction>(Compare);
    return IsOperand || !TextRelation.empty()
               ? *llvm::cast<llvm::Instruction>(FlagValue)
               : *Predicate;
  }
  llvm::StringRef typeName() const;
  /// The operator with the threshold on the right-hand side, or `flag`.
  llvm::StringRef relation() const;
};

/// A comparison with a parameter that is not reported, and why.
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
  /// In the order of the reads and then of the way forward.
  std::vector<Comparison> Comparisons;
  /// Those with a constant, in the order of the program. None of them is in
  /// the list above.
  std::vector<Comparison> Constants;
  unsigned OutsideSources = 0; ///< comparisons in code that is not the user's
  /// Functions that compare a parameter which one of several calls handed
  /// them: their other calls compare something else.
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
