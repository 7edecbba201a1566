//===- Functions.h - The functions that are analysed ----------------------===//
#ifndef TPC_FUNCTIONS_H
#define TPC_FUNCTIONS_H

#include "llvm/ADT/STLExtras.h"
#include "llvm/IR/Module.h"

namespace tpc {

/// The functions that \p M defines and that can run. What is only there to be
/// inlined, and is so only above -O0 (`available_externally`), is another
/// module's: without it the findings are the same at every level. What nobody
/// uses and the linker may leave out never runs.
inline auto definedFunctions(llvm::Module &M) {
  return llvm::make_filter_range(M, [](const llvm::Function &F) {
    return !F.isDeclarationForLinker() &&
           !(F.use_empty() && F.isDiscardableIfUnused());
  });
}

} // namespace tpc

#endif // TPC_FUNCTIONS_H
