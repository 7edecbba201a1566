//===- Variables.h - Names of variables, from debug information -----------===//
#ifndef TPC_VARIABLES_H
#define TPC_VARIABLES_H

#include "memory/LocationTypes.h"

namespace tpc {

/// Names the variables of a module as its source does.
class VariableNames {
public:
  explicit VariableNames(const LocationTypes &Types) : Types(Types) {}

  /// The name of the field, global or local alone; empty if it has none.
  std::string nameOf(const Location &L) const;
  /// The same; a field has the name of its class before it: `Node::limit_`.
  std::string fullNameOf(const Location &L) const;

private:
  /// The innermost field of \p L that has a name, and its class.
  std::pair<const llvm::DICompositeType *, llvm::StringRef>
  fieldOf(const Location &L) const;
  std::string rootName(const llvm::Value *Root) const;
  const LocationTypes &Types;
};

} // namespace tpc

#endif // TPC_VARIABLES_H
