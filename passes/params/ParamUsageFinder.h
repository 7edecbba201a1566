//===- ParamUsageFinder.h - Where a parameter's value is compared ---------===//
//
// Thesis A.11: follows each parameter read forward, through copies, casts,
// variables, arguments and results, to the comparisons, and from those to the
// predicates. Arithmetic is recorded with the value. A value is lost, and
// counted, where it is accumulated, or computed with other variables and then
// compared with a constant: no threshold is left.
//
// Calls are matched: a value that entered a function by one call leaves it by
// the same call.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_PARAMUSAGEFINDER_H
#define TPC_PARAMUSAGEFINDER_H

#include "params/Transform.h"

#include "llvm/ADT/SmallVector.h"
#include "llvm/IR/InstrTypes.h"
#include "llvm/IR/PassManager.h"

namespace tpc {

/// The operator of the source for \p P; empty if \p P does not compare values:
/// `isunordered(a, b)` asks whether they are numbers, and `fcmp true` asks
/// nothing.
llvm::StringRef relationOf(llvm::CmpInst::Predicate P);

/// True if \p Compare compares the values of its operands.
bool comparesValues(const llvm::CmpInst &Compare);

/// One step of the path of a value.
struct Hop {
  llvm::Value *To;        ///< what holds the value now
  llvm::Instruction *Via; ///< what passed it on; To itself if it computes
  unsigned From;          ///< number of the previous hop; None for a read
  static constexpr unsigned None = ~0U;
};

/// A predicate that an outcome decides, and whether the outcome reaches it
/// inside one function by SSA values that no phi merges.
struct Decision {
  llvm::Instruction *Predicate;
  bool Direct;
  unsigned Way = Hop::None; ///< number of the hop that ends at the predicate
};

/// A place behind which the value of a parameter, or the outcome of a
/// comparison with it, is not followed, or not with certainty.
struct ValueEnd {
  enum KindTy {
    Mixed,          ///< it was accumulated, or went where nobody looks
    NoNumber,       ///< the type of the parameter is not followed
    Unread,         ///< it was stored, and nothing loads it
    UnknownPointer, ///< it was stored to an unknown place
    ManyTargets,    ///< it was stored to one of very many variables
    Outcome,        ///< the outcome of its comparison went where nobody looks
  };
  KindTy Kind;
  unsigned Read; ///< number of the read
  llvm::Instruction *At;

  /// True if nothing is known of the value behind this place.
  bool isLost() const { return Kind == Mixed || Kind == NoNumber; }
};

/// One comparison with the value of one parameter read.
struct ParameterComparison {
  unsigned Read; ///< number of the read
  /// The comparison; null for a flag.
  llvm::CmpInst *Compare = nullptr;
  unsigned Operand = 0; ///< which operand is the value of the parameter
  /// For a flag (or a switch), the value that decides, and whether it decides
  /// where it is read, as an operand of `&&` or `||` whose outcome is used
  /// further.
  llvm::Value *Flag = nullptr;
  bool IsOperand = false;
  /// For a comparison of text, whose outcome is Flag: its operator.
  llvm::StringRef TextRelation;
  /// The value came by an argument, or from an object that is one, and the
  /// function has other calls.
  bool ByArgument = false;
  Transform How;
  llvm::SmallVector<Decision, 2> Decisions;

  /// The instruction at its place in the source.
  const llvm::Instruction &place() const {
    if (Compare)
      return *Compare;
    // The outcome of a comparison of text may decide nothing.
    return IsOperand || Decisions.empty() ? *llvm::cast<llvm::Instruction>(Flag)
                                          : *Decisions.front().Predicate;
  }
};

struct ParameterUsage {
  std::vector<ParameterComparison> Comparisons;
  std::vector<Hop> Hops;
  std::vector<ValueEnd> Ends;

  /// Places where a value was combined with another variable.
  unsigned lost() const;
  /// The path from the read to the hop \p Last.
  llvm::SmallVector<Hop, 16> pathTo(unsigned Last) const;
};

class ParamUsageFinder : public llvm::AnalysisInfoMixin<ParamUsageFinder> {
public:
  using Result = ParameterUsage;
  Result run(llvm::Module &M, llvm::ModuleAnalysisManager &AM);

private:
  friend llvm::AnalysisInfoMixin<ParamUsageFinder>;
  static llvm::AnalysisKey Key;
};

/// `print<tpc-param-usage>`
class ParamUsageFinderPrinter
    : public llvm::PassInfoMixin<ParamUsageFinderPrinter> {
public:
  explicit ParamUsageFinderPrinter(llvm::raw_ostream &OS) : OS(OS) {}
  llvm::PreservedAnalyses run(llvm::Module &M, llvm::ModuleAnalysisManager &AM);
  static bool isRequired() { return true; }

private:
  llvm::raw_ostream &OS;
};

} // namespace tpc

#endif // TPC_PARAMUSAGEFINDER_H
