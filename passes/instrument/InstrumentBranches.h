//===- InstrumentBranches.h - Inserts the reports -------------------------===//
//
// Thesis A.13: inserts a call of log_one before each predicate of a threshold
// predicate comparison, with the key, the outcomes and both values, and
// log_one_of where the object is an instance. No other code of TPC changes what
// a program does.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_INSTRUMENTBRANCHES_H
#define TPC_INSTRUMENTBRANCHES_H

#include "instrument/Prepare.h"
#include "results/GatherResults.h"

#include "llvm/IR/Instructions.h"

#include <optional>

namespace tpc {

/// A report to insert, in terms of the instrumented program.
struct Report {
  std::string Key;
  /// The instruction before which the report is inserted.
  llvm::Instruction *Before;
  llvm::Value *Result; ///< the predicate's outcome (any integer)
  /// If the predicate is a switch: its outcome is whether it takes a case.
  llvm::SwitchInst *Switch = nullptr;
  llvm::Value *Compared; ///< the value that is compared with the threshold
  llvm::Value *Threshold;
  /// If those two are objects that hold a number: the call that compares them.
  llvm::CallBase *Held = nullptr;
  const Rule *HeldRow = nullptr; ///< describes Held
  llvm::Value *Outcome;          ///< the outcome of the comparison
  /// The object whose evaluations are reported apart (Instances.h), if any.
  llvm::Value *Object = nullptr;
  bool Signed = true; ///< whether integers are signed
};

/// The instruction before which what follows \p I is inserted; null if no place
/// follows \p I alone.
llvm::Instruction *insertionPointAfter(llvm::Instruction &I);

/// The report for \p C; none if a value of the analysed program has no
/// counterpart in the original program. \p IsUnsigned says whether the type of
/// the parameter is unsigned. If the operands do not reach the predicate, the
/// report stands where the comparison is evaluated; its outcome of the
/// predicate is then that of everything joined there without control flow.
std::optional<Report> planReport(const Comparison &C, bool IsUnsigned,
                                 const AnalysedModule &Analysed);

/// Inserts \p Reports. If the module does not verify afterwards, removes them
/// and returns the reason; otherwise returns an empty string.
std::string insertReports(llvm::Module &M, llvm::ArrayRef<Report> Reports);

/// `print<tpc-instrument-branches>`: prints where reports would be inserted.
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
