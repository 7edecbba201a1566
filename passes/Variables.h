//===- Variables.h - Names of variables, from debug information -----------===//
#ifndef TPC_VARIABLES_H
#define TPC_VARIABLES_H

#include "ClassObjectAccess.h"

#include "llvm/ADT/StringMap.h"
#include "llvm/IR/DebugInfoMetadata.h"

namespace tpc {

/// Names the variables of a module as its source does.
class VariableNames {
public:
  VariableNames(const llvm::Module &M, const TypeNumbers &Types);

  /// The field's, global's or local's own name; empty where it has none.
  std::string nameOf(const Location &L) const;

private:
  const llvm::DataLayout &Layout;
  const TypeNumbers &Types;
  llvm::StringMap<llvm::SmallVector<const llvm::DICompositeType *, 1>> Classes;
};

} // namespace tpc

#endif // TPC_VARIABLES_H
