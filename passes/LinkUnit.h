//===- LinkUnit.h - What happens to one link unit -------------------------===//
#ifndef TPC_LINKUNIT_H
#define TPC_LINKUNIT_H

#include "llvm/IR/PassManager.h"
#include "llvm/Passes/PassBuilder.h"

namespace tpc {

/// Registers the analyses of TPC.
void registerAnalyses(llvm::ModuleAnalysisManager &AM);

/// `tpc`: analyses a link unit, puts the reports into it and writes its static
/// information. Whatever goes wrong inside, the unit is left as it was, with
/// one warning and a file that says why: a build never breaks because of this.
class LinkUnitPass : public llvm::PassInfoMixin<LinkUnitPass> {
public:
  llvm::PreservedAnalyses run(llvm::Module &M, llvm::ModuleAnalysisManager &);
  static bool isRequired() { return true; }
};

/// The optimisation that the compiler was told to leave out, so that the
/// program could be analysed as it was written: the pipeline that it runs
/// before a link, at the level that the compiler was asked for.
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
