//===- LinkUnit.h - The passes that run on a link unit --------------------===//
#ifndef TPC_LINKUNIT_H
#define TPC_LINKUNIT_H

#include "llvm/IR/PassManager.h"
#include "llvm/Passes/PassBuilder.h"

namespace tpc {

/// Registers the analyses of TPC.
void registerAnalyses(llvm::ModuleAnalysisManager &AM);

/// `tpc`: analyses a link unit, inserts the reports and writes the static
/// information. If anything fails, the link unit stays unchanged, the linker
/// prints one warning and the file gives the reason: TPC never breaks a build.
class LinkUnitPass : public llvm::PassInfoMixin<LinkUnitPass> {
public:
  llvm::PreservedAnalyses run(llvm::Module &M, llvm::ModuleAnalysisManager &);
  static bool isRequired() { return true; }
};

/// Runs the optimisation that the compiler left out so that the program could
/// be analysed as written: the pre-link pipeline, at the level that the
/// compiler was given.
class PrelinkPass : public llvm::PassInfoMixin<PrelinkPass> {
public:
  explicit PrelinkPass(llvm::PassBuilder &PB) : PB(PB) {}
  llvm::PreservedAnalyses run(llvm::Module &M, llvm::ModuleAnalysisManager &);
  static bool isRequired() { return true; }

private:
  llvm::PassBuilder &PB;
};

} // namespace tpc

#endif // TPC_LINKUNIT_H
