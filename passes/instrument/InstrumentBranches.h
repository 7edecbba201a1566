//===- InstrumentBranches.h - Puts the reports into the program -----------===//
//
// Thesis A.13: before each predicate of a threshold predicate comparison a
// call of log_one with the key, the outcomes and both values. The only code of
// TPC that changes what a program does.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_INSTRUMENTBRANCHES_H
#define TPC_INSTRUMENTBRANCHES_H

#include "instrument/Prepare.h"
#include "results/GatherResults.h"

#include "llvm/IR/Instructions.h"

#include <optional>

namespace tpc {

/// A report to insert, in terms of the program that is instrumented.
struct Report {
  std::string Key;
  /// Before this instruction.
  llvm::Instruction *Before;
  llvm::Value *Result; ///< the predicate's outcome (any integer)
  /// Where the predicate is a switch, whose outcome is whether it takes a case.
  llvm::SwitchInst *Switch = nullptr;
  llvm::Value *Compared; ///< what is compared with the threshold
  llvm::Value *Threshold;
  llvm::Value *Outcome; ///< the comparison's outcome
  bool Signed;          ///< how integers are to be read
};

/// The report for \p C, or none where a value of the analysed program has no
/// counterpart in the original. \p IsUnsigned says so of the parameter's type.
/// Where the operands do not come to the predicate, the report stands where the
/// comparison is evaluated, and has as outcome of the predicate that of all
/// that is joined there without control flow.
std::optional<Report> planReport(const Comparison &C, bool IsUnsigned,
                                 const AnalysedModule &Analysed);

/// Inserts \p Reports. Where the module does not verify afterwards, takes them
/// out again and returns why; else returns nothing.
std::string insertReports(llvm::Module &M, llvm::ArrayRef<Report> Reports);

/// `print<tpc-instrument-branches>`: where reports would be put.
class InstrumentBranchesPrinter
    : public llvm::PassInfoMixin<InstrumentBranchesPrinter> {
public:
  explicit InstrumentBranchesPrinter(llvm::raw_ostream &OS) : OS(OS) {}
  llvm::PreservedAnalyses run(llvm::Module &M, llvm::ModuleAnalysisManager &AM);
  static bool isRequired() { return true; }

private:
  llvm::raw_ostream &OS;
};

} // namespace tpc

#endif // TPC_INSTRUMENTBRANCHES_H
