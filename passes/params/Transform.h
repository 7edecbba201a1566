//===- Transform.h - Arithmetic that a parameter went through -------------===//
//
// A threshold that was computed from a parameter and constants (type `derived`,
// docs/reference/glossary.md#derived-comparison). The arithmetic is kept, so
// that a suggestion can be given in the parameter's own unit: affine steps are
// folded into a scale and an offset, all others become an expression over x,
// the parameter.
//
// Real numbers stand for the program's: rounding, and integers that overflow,
// are not modelled, but where a conversion itself cuts something off.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_TRANSFORM_H
#define TPC_TRANSFORM_H

#include "llvm/IR/InstrTypes.h"
#include "llvm/Support/JSON.h"

#include <memory>
#include <optional>
#include <string>

namespace tpc {

struct Application;

/// What was done to a parameter's value before it was compared:
/// Scale * inner + Offset, where inner is x or a function of a transform.
struct Transform {
  enum KindTy { None, Affine, Expression };
  double Scale = 1, Offset = 0;
  std::shared_ptr<const Application> Inner; ///< null: x itself
  /// Bits of an integer type that the value is known to fit into; 0: none.
  unsigned Width = 0;

  KindTy kind() const;
  void multiply(double Factor);
  void divide(double Divisor);
  void add(double Term);
  /// \p Op of what stands so far, with a constant behind it or, with \p First,
  /// before it.
  void call(llvm::StringRef Op, std::optional<double> Constant = std::nullopt,
            bool First = false);
  /// For people: `2 * sqrt(x + 1)`.
  std::string text() const;
  /// True where nothing was done but to keep the value in fewer bits: it is
  /// meant to fit.
  bool isNarrowing() const;
  /// The same for programs (docs/reference/formats.md): a number, "x", or a
  /// list of an operator and its operands.
  llvm::json::Value tree() const;
};

/// One function of a transform.
struct Application {
  std::string Op; ///< see docs/reference/formats.md
  Transform Of;
  std::optional<double> Constant;
  bool First; ///< the constant stands before the transform
};

/// \p T after \p I, an operation on \p V other than a cast; none where \p I is
/// no arithmetic with constants alone, nor a product of V with itself: then
/// \p Square is 1, or -1 where one of the two is negated, else 0.
std::optional<Transform> apply(Transform T, const llvm::Instruction &I,
                               const llvm::Value *V, int Square);

/// \p T after \p Cast, which can change the value where the new type is
/// narrower, or holds whole numbers.
Transform applyCast(Transform T, const llvm::CastInst &Cast);

/// The value of \p V where it is a constant number or a conversion of one.
std::optional<double> constantNumber(const llvm::Value *V,
                                     bool Unsigned = false);

/// The shortest text that reads back as \p X.
std::string shortest(double X);

} // namespace tpc

#endif // TPC_TRANSFORM_H
