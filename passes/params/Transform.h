//===- Transform.h - Arithmetic between a parameter and a comparison ------===//
//
// A threshold that is computed from a parameter (type `derived`,
// docs/reference/glossary.md#derived-comparison). The arithmetic is recorded,
// so that a suggestion can be given in the unit of the parameter. Affine steps
// are folded into a scale and an offset; all others become an expression over
// x, the parameter. A value that is not constant is an operand with its name in
// the source: the expression can be read, but not computed.
//
// The arithmetic is that of real numbers: rounding and integer overflow are not
// modelled, except that a conversion may cut something off.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_TRANSFORM_H
#define TPC_TRANSFORM_H

#include "llvm/ADT/STLFunctionalExtras.h"
#include "llvm/IR/InstrTypes.h"
#include "llvm/Support/JSON.h"

#include <memory>
#include <optional>
#include <string>

namespace tpc {

struct Application;

/// The arithmetic between a parameter and a comparison: Scale * inner + Offset,
/// where inner is x or a function of a transform.
struct Transform {
  /// Variables that are all configured come before those that are measured.
  enum KindTy { None, Affine, Expression, OfParameters, WithVariables };
  double Scale = 1, Offset = 0;
  std::shared_ptr<const Application> Inner; ///< null: x itself
  /// The bits of an integer type that the value is known to fit into; 0: none.
  unsigned Width = 0;
  unsigned Variables = 0; ///< operands that are not constant
  bool Measured = false;  ///< one of them is not known to be configured
  bool Merged = false; ///< x is one of several values that the program chooses
  /// x is the smaller or larger of a value that is not configured and itself.
  bool Limiting = false;
  /// What of a parameter that is a list or struct is taken: `element`, or what
  /// a row of `properties` calls it; empty for the value itself.
  std::string Part = "";

  KindTy kind() const;
  void multiply(double Factor);
  void divide(double Divisor);
  void add(double Term);
  /// Applies \p Op to the transform; a constant is the second operand or, with
  /// \p First, the first.
  void call(llvm::StringRef Op, std::optional<double> Constant = std::nullopt,
            bool First = false);
  /// The same with a second operand that is not constant, called \p Name.
  void combine(llvm::StringRef Op, std::string Name, bool First = false);
  /// True for the plain difference to a value that is not constant: compared
  /// with zero, it compares the two.
  bool isDifference() const;
  /// True for the remainder of a value that is not constant, divided by the
  /// parameter: every x-th time.
  bool isRemainder() const;
  /// For people: `2 * sqrt(x + 1)`, `x[]` for an element of a list, `size(x)`.
  std::string text() const;
  /// True if the only steps truncate the value to fewer bits: it is expected to
  /// fit.
  bool isNarrowing() const;
  /// The same for programs (docs/reference/formats.md): a number, "x", or a
  /// list of an operator and its operands. Not with Variables, and not
  /// if there is a Part.
  llvm::json::Value tree() const;
};

/// One function applied to a transform.
struct Application {
  std::string Op; ///< see docs/reference/formats.md
  Transform Of;
  std::optional<double> Constant;
  bool First; ///< the constant, or the variable, is the first operand
  std::string Variable = ""; ///< the second operand if it is not constant
};

/// The name of a value in the source; empty if it has none.
using NameOf = llvm::function_ref<std::string(const llvm::Value *)>;

/// \p T after \p I, an operation on \p V other than a cast; none unless \p I is
/// arithmetic. \p Name names operands that are not constant; none if there are
/// too many of them, or the value was merged with others. If \p I multiplies V
/// with itself, \p Square is 1, or -1 if one factor is negated; otherwise 0.
std::optional<Transform> apply(Transform T, const llvm::Instruction &I,
                               const llvm::Value *V, int Square, NameOf Name);

/// True if \p T is a formula with values that may be measured. Other formulas
/// are thresholds as a parameter is.
inline bool isMeasured(const Transform &T) {
  return T.kind() == Transform::WithVariables;
}

/// \p T after \p Cast, which can change the value if the new type is narrower,
/// or holds integers.
Transform applyCast(Transform T, const llvm::CastInst &Cast);

/// The value of \p V if it is a constant number or a conversion of one.
std::optional<double> constantNumber(const llvm::Value *V,
                                     bool Unsigned = false);

/// The shortest text that reads back as \p X.
std::string shortest(double X);

/// \p T without its steps if they only narrow: who keeps a parameter in a
/// smaller integer knows that it fits.
Transform withoutNarrowing(Transform T);

} // namespace tpc

#endif // TPC_TRANSFORM_H
