//===- ParamUsageFinder.h - Where a parameter's value is compared ---------===//
//
// Thesis A.11: forward from each parameter read, through copies, casts,
// variables, arguments and results, to the comparisons, and from those to the
// predicates. A value that went through arithmetic with constants is kept, with
// the arithmetic; one that meets another variable is lost, and counted.
//
// Calls are matched on the way forward: a value that went into a function by
// one call comes out by that call.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_PARAMUSAGEFINDER_H
#define TPC_PARAMUSAGEFINDER_H

#include "params/Transform.h"

#include "llvm/ADT/SmallVector.h"
#include "llvm/IR/InstrTypes.h"
#include "llvm/IR/PassManager.h"

namespace tpc {

/// True where \p Compare asks how its operands compare. `isunordered(a, b)`
/// asks whether they are numbers, and `fcmp true` asks nothing.
bool comparesValues(const llvm::CmpInst &Compare);

/// One step of a value's way forward.
struct Hop {
  llvm::Value *To; ///< what holds the value now
  llvm::Instruction
      *Via;      ///< what brought it there; To itself where it computes
  unsigned From; ///< number of the hop before; None for a read
  static constexpr unsigned None = ~0U;
};

/// A predicate that an outcome decides, and whether the outcome comes to it
/// inside its function by SSA values that control flow does not merge.
struct Decision {
  llvm::Instruction *Predicate;
  bool Direct;
  unsigned Way = Hop::None; ///< number of the hop that ends at the predicate
};

/// A place behind which a parameter's value, or the outcome of a comparison
/// with it, is not followed, or not surely.
struct ValueEnd {
  enum KindTy {
    Mixed,          ///< it met another variable, or went where nobody looks
    NoNumber,       ///< the parameter is of a type that is not followed
    Unread,         ///< it was stored, and nothing loads it
    UnknownPointer, ///< it was stored where nobody knows
    ManyTargets,    ///< it was stored to one of very many variables
    Outcome,        ///< its comparison's outcome went where nobody looks
  };
  KindTy Kind;
  unsigned Read; ///< number of the read
  llvm::Instruction *At;
};

/// One comparison with one parameter read's value.
struct ParameterComparison {
  unsigned Read; ///< number of the read
  /// The comparison; null for a flag.
  llvm::CmpInst *Compare = nullptr;
  unsigned Operand = 0; ///< which operand is the parameter's value
  /// For a flag (or a switch) the value that decides, and whether it does so
  /// where it is read, as an operand of `&&` or `||` whose outcome goes on.
  llvm::Value *Flag = nullptr;
  bool IsOperand = false;
  /// For a comparison of text, which Flag is the outcome of, its operator.
  llvm::StringRef TextRelation;
  /// The value came by an argument, and the function has other calls.
  bool ByArgument = false;
  Transform How;
  llvm::SmallVector<Decision, 2> Decisions;

  /// Where it stands in the source.
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

  /// Places where a value was mixed with another variable.
  unsigned lost() const;
  /// The way from the read to the hop number \p Last.
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
