//===- Functions.h - The functions that are analysed ----------------------===//
#ifndef TPC_FUNCTIONS_H
#define TPC_FUNCTIONS_H

#include "llvm/ADT/STLExtras.h"
#include "llvm/IR/Module.h"

namespace tpc {

/// The attribute of a function of a process: the link unit that defines it, the
/// first one of several. tpc-merge sets it.
inline constexpr llvm::StringLiteral UnitMark = "tpc-unit";

/// The attribute of a function of a process that only its unit calls: the unit,
/// a colon and its name there. In the process its name may differ, because
/// another unit has one of that name. tpc-merge sets it.
inline constexpr llvm::StringLiteral LocalOf = "tpc-local";

/// The unit that \p F is marked with as the only one that calls it, and its
/// name there.
inline llvm::StringRef unitOf(const llvm::Function &F) {
  return F.getFnAttribute(LocalOf).getValueAsString().split(':').first;
}
inline llvm::StringRef nameInUnit(const llvm::Function &F) {
  return F.getFnAttribute(LocalOf).getValueAsString().split(':').second;
}

/// The functions that \p M defines and that can run. Left out are definitions
/// that only exist for inlining, which is so only above -O0
/// (`available_externally`): they belong to another module, and without them
/// the findings are the same at every level. Also left out are unused functions
/// that the linker may discard: they never run.
inline auto definedFunctions(llvm::Module &M) {
  return llvm::make_filter_range(M, [](const llvm::Function &F) {
    return !F.isDeclarationForLinker() &&
           !(F.use_empty() && F.isDiscardableIfUnused());
  });
}

} // namespace tpc

#endif // TPC_FUNCTIONS_H
