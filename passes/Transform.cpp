//===- Transform.cpp ------------------------------------------------------===//
#include "Transform.h"

#include "llvm/IR/Constants.h"
#include "llvm/IR/Instructions.h"
#include "llvm/IR/IntrinsicInst.h"

#include <charconv>

using namespace llvm;

namespace tpc {

/// The shortest text that reads back as \p X.
static std::string shortest(double X) {
  char Buffer[32];
  auto End = std::to_chars(Buffer, Buffer + sizeof(Buffer), X).ptr;
  return std::string(Buffer, End);
}

void Transform::multiply(double Factor) {
  if (Kind == Expression)
    return wrap("(", ") * " + shortest(Factor));
  Kind = Affine;
  Scale *= Factor;
  Offset *= Factor;
}

void Transform::add(double Term) {
  if (Kind == Expression)
    return wrap("", " + " + shortest(Term));
  Kind = Affine;
  Offset += Term;
}

void Transform::wrap(const std::string &Before, const std::string &After) {
  Text = Before + text() + After;
  Kind = Expression;
}

std::string Transform::text() const {
  if (Kind == None || Kind == Expression)
    return Text;
  std::string T = Scale == 1 ? "x" : shortest(Scale) + " * x";
  if (Offset != 0)
    T += (Offset < 0 ? " - " : " + ") + shortest(Offset < 0 ? -Offset : Offset);
  return T;
}

/// The value of \p V where it is a constant number.
static std::optional<double> constantNumber(const Value *V) {
  if (const auto *Int = dyn_cast<ConstantInt>(V))
    return Int->getBitWidth() <= 64
               ? std::optional<double>(static_cast<double>(Int->getSExtValue()))
               : std::nullopt;
  const auto *Float = dyn_cast<ConstantFP>(V);
  if (!Float)
    return std::nullopt;
  APFloat Value = Float->getValueAPF();
  bool Loses;
  Value.convert(APFloat::IEEEdouble(), APFloat::rmNearestTiesToEven, &Loses);
  return Value.convertToDouble();
}

/// Applies `V op C` (or `C op V` where \p Left) to \p T; false where that is
/// no arithmetic that is kept.
static bool applyConstant(Transform &T, unsigned Opcode, double C, bool Left) {
  switch (Opcode) {
  case Instruction::Add:
  case Instruction::FAdd:
    T.add(C);
    return true;
  case Instruction::Sub:
  case Instruction::FSub:
    if (Left)
      T.multiply(-1);
    T.add(Left ? C : -C);
    return true;
  case Instruction::Mul:
  case Instruction::FMul:
    T.multiply(C);
    return true;
  case Instruction::FDiv:
    if (Left)
      T.wrap(shortest(C) + " / (", ")");
    else
      T.multiply(1 / C);
    return C != 0;
  case Instruction::SDiv:
  case Instruction::UDiv:
    if (Left)
      T.wrap(shortest(C) + " div (", ")");
    else
      T.wrap("(", ") div " + shortest(C));
    return C != 0;
  default:
    return false;
  }
}

std::optional<Transform> apply(Transform T, const Instruction &I,
                               const Value *V, bool Square) {
  if (I.getOpcode() == Instruction::FNeg) {
    T.multiply(-1);
    return T;
  }
  if (const auto *Fma = dyn_cast<IntrinsicInst>(&I);
      Fma && Fma->getIntrinsicID() == Intrinsic::fmuladd) {
    const Value *Other = Fma->getArgOperand(Fma->getArgOperand(0) == V ? 1 : 0);
    auto Factor = constantNumber(Other);
    auto Term = constantNumber(Fma->getArgOperand(2));
    if (!Factor || !Term)
      return std::nullopt;
    T.multiply(*Factor);
    T.add(*Term);
    return T;
  }
  if (!isa<BinaryOperator>(I))
    return std::nullopt;
  const Value *L = I.getOperand(0), *R = I.getOperand(1);
  if (Square) {
    T.wrap("(", ")^2");
    return T;
  }
  auto C = constantNumber(L == V ? R : L);
  if (!C || !applyConstant(T, I.getOpcode(), *C, R == V))
    return std::nullopt;
  return T;
}

} // namespace tpc
