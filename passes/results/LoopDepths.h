//===- LoopDepths.h - In how many loops a comparison is evaluated ---------===//
//
// A report costs what its comparison costs, once for each evaluation. In an
// inner loop that can be millions a second, so the build says which comparisons
// are in one.
//
// Natural loops, as LLVM's LoopInfo finds them: those of the function, and
// those around the calls that lead to it from at most a few functions further
// up; of several ways, the one with most loops. Two kinds of loops do not
// count:
// - One that waits, such as a node's main loop: something else sets its pace.
// - One of a library that user code does not call into: what delivers messages
//   to several callbacks runs once for each message.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_LOOPDEPTHS_H
#define TPC_LOOPDEPTHS_H

#include "llvm/ADT/DenseMap.h"
#include "llvm/IR/Instruction.h"
#include "llvm/IR/PassManager.h"

namespace tpc {

struct Comparison;

class LoopDepthsResult {
public:
  unsigned of(const Comparison &C) const;

private:
  friend class LoopDepths;
  /// By the instruction at the comparison's place; without those in no loop.
  llvm::DenseMap<const llvm::Instruction *, unsigned> Depths;
};

class LoopDepths : public llvm::AnalysisInfoMixin<LoopDepths> {
public:
  using Result = LoopDepthsResult;
  Result run(llvm::Module &M, llvm::ModuleAnalysisManager &AM);

private:
  friend llvm::AnalysisInfoMixin<LoopDepths>;
  static llvm::AnalysisKey Key;
};

/// `print<tpc-loop-depths>`
class LoopDepthsPrinter : public llvm::PassInfoMixin<LoopDepthsPrinter> {
public:
  explicit LoopDepthsPrinter(llvm::raw_ostream &OS) : OS(OS) {}
  llvm::PreservedAnalyses run(llvm::Module &M, llvm::ModuleAnalysisManager &AM);
  static bool isRequired() { return true; }

private:
  llvm::raw_ostream &OS;
};

} // namespace tpc

#endif // TPC_LOOPDEPTHS_H
