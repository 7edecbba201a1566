//===- Transform.h - Arithmetic that a parameter went through -------------===//
#ifndef TPC_TRANSFORM_H
#define TPC_TRANSFORM_H

#include "llvm/IR/Instruction.h"

#include <optional>
#include <string>

namespace tpc {

/// What was done to a parameter's value before it was compared.
struct Transform {
  enum KindTy { None, Affine, Expression };
  KindTy Kind = None;
  double Scale = 1, Offset = 0; ///< of an affine one: Scale * x + Offset
  std::string Text = "x";       ///< of an expression, in terms of x

  void multiply(double Factor);
  void add(double Term);
  /// `\p Before` text `\p After` around what stands so far.
  void wrap(const std::string &Before, const std::string &After);
  std::string text() const;
};

/// \p T after \p I, an operation on \p V; none where \p I is no arithmetic
/// with constants alone, nor the square (\p Square).
std::optional<Transform> apply(Transform T, const llvm::Instruction &I,
                               const llvm::Value *V, bool Square);

} // namespace tpc

#endif // TPC_TRANSFORM_H
