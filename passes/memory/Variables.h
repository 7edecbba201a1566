//===- Variables.h - Names of variables, from debug information -----------===//
#ifndef TPC_VARIABLES_H
#define TPC_VARIABLES_H

#include "memory/PointsTo.h"

namespace tpc {

/// True for the call that clang generates for `a * b + c`, which is no call in
/// the source.
bool isMultiplyAdd(const llvm::Instruction &I);

/// The name of \p V, a local variable or argument of its function \p F; empty
/// if it has none.
std::string localName(const llvm::Value &V, const llvm::Function &F);

/// Names the variables of a module as its source does.
class VariableNames {
public:
  explicit VariableNames(const LocationTypes &Types) : Types(Types) {}

  /// The name of the field, global or local alone; empty if it has none.
  std::string nameOf(const Location &L) const;
  /// The same; a field has the name of its class before it: `Node::limit_`.
  std::string fullNameOf(const Location &L) const;
  /// The variable or call that \p V is, a value that is not constant; empty if
  /// it is neither.
  std::string nameOf(const llvm::Value *V, PointsTo &Pointers) const;

private:
  /// The innermost field of \p L that has a name, and its class.
  std::pair<const llvm::DICompositeType *, llvm::StringRef>
  fieldOf(const Location &L) const;
  std::string rootName(const llvm::Value *Root) const;
  const LocationTypes &Types;
};

} // namespace tpc

#endif // TPC_VARIABLES_H
