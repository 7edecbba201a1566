//===- Transform.cpp ------------------------------------------------------===//
#include "params/Transform.h"

#include "llvm/ADT/StringSwitch.h"
#include "llvm/IR/Constants.h"
#include "llvm/IR/Instructions.h"
#include "llvm/IR/IntrinsicInst.h"
#include "llvm/Support/CommandLine.h"

#include <charconv>
#include <cmath>

using namespace llvm;

namespace tpc {

/// What is computed from more values than this is no threshold that somebody
/// has set.
static cl::opt<unsigned> MaxVariables(
    "tpc-max-variables", cl::Hidden, cl::init(2),
    cl::desc("Operands other than constants in the arithmetic between a "
             "parameter and a comparison"));

std::string shortest(double X) {
  char Buffer[32];
  auto *End = std::to_chars(Buffer, Buffer + sizeof(Buffer), X).ptr;
  return std::string(Buffer, End);
}

//===----------------------------------------------------------------------===//
// The expression
//===----------------------------------------------------------------------===//

Transform::KindTy Transform::kind() const {
  if (Variables)
    return Measured ? WithVariables : OfParameters;
  if (Inner)
    return Expression;
  return Scale == 1 && Offset == 0 ? None : Affine;
}

void Transform::multiply(double Factor) {
  Scale *= Factor;
  Offset *= Factor;
  Width = 0;
}

void Transform::divide(double Divisor) {
  Scale /= Divisor;
  Offset /= Divisor;
  Width = 0;
}

void Transform::add(double Term) {
  Offset += Term;
  Width = 0;
}

void Transform::call(StringRef Op, std::optional<double> Constant, bool First) {
  Transform Outer;
  Outer.Variables = Variables;
  Outer.Measured = Measured;
  Outer.Merged = Merged;
  Outer.Limiting = Limiting;
  Outer.Part = Part;
  Outer.Inner = std::make_shared<const Application>(
      Application{Op.str(), std::move(*this), Constant, First});
  *this = std::move(Outer);
}

void Transform::combine(StringRef Op, std::string Name, bool First) {
  Transform Outer;
  Outer.Variables = Variables + 1;
  Outer.Measured = Measured;
  Outer.Part = Part;
  Outer.Inner = std::make_shared<const Application>(Application{
      Op.str(), std::move(*this), std::nullopt, First, std::move(Name)});
  *this = std::move(Outer);
}

bool Transform::isDifference() const {
  return Inner && Inner->Op == "-" && Offset == 0;
}

bool Transform::isRemainder() const {
  return Inner && Inner->Op == "rem" && Inner->First && !Inner->Constant &&
         Inner->Of.kind() == None && Scale == 1 && Offset == 0;
}

/// The sign between two operands; empty for the name of a function.
static StringRef signOf(const Application &A) {
  return StringSwitch<StringRef>(A.Op)
      .Case("+", " + ")
      .Case("-", " - ")
      .Case("*", " * ")
      .Case("/", " / ")
      .Case("rem", " rem ")
      .Case("shr", " >> ")
      .Case("and", " & ")
      .Default("");
}

static bool isSquare(const Application &A) {
  return A.Op == "pow" && !A.First && A.Constant == 2;
}

namespace {
/// How strongly the operands of a text hold together.
enum Level { Other, Sum, Product, Single };
} // namespace

static Level levelOf(const Transform &T) {
  if (T.Offset != 0)
    return Sum;
  if (T.Scale != 1)
    return Product;
  if (!T.Inner)
    return Single;
  if (isSquare(*T.Inner))
    return Product;
  return StringSwitch<Level>(signOf(*T.Inner))
      .Case("", Single)
      .Case(" + ", Sum)
      .Case(" - ", Sum)
      .Case(" * ", Product)
      .Case(" / ", Product)
      .Default(Other);
}

/// The text of \p T as an operand that needs \p Least.
static std::string operandText(const Transform &T, Level Least = Single) {
  return levelOf(T) >= Least ? T.text() : "(" + T.text() + ")";
}

/// What the first operand of \p A, between signs, needs.
static Level leastOf(const Application &A) {
  if (A.Op == "+" || A.Op == "-")
    return A.First ? Product : Sum;
  return A.Op == "*" ? Product : Single;
}

/// The text of the second operand of \p A; empty if it has none.
static std::string otherText(const Application &A) {
  return A.Constant ? shortest(*A.Constant) : A.Variable;
}

static std::string applicationText(const Application &A) {
  if (isSquare(A))
    return operandText(A.Of) + "^2";
  if (A.Op == "wrap" || A.Op == "wrapu")
    return A.Op + shortest(*A.Constant) + "(" + A.Of.text() + ")";
  if (A.Op == "div") {
    std::string X = operandText(A.Of), C = otherText(A);
    return "trunc(" + (A.First ? C + " / " + X : X + " / " + C) + ")";
  }
  StringRef Sign = signOf(A);
  std::string C = otherText(A);
  if (C.empty())
    return A.Op + "(" + A.Of.text() + ")";
  std::string Own = Sign.empty() ? A.Of.text() : operandText(A.Of, leastOf(A));
  std::string Middle = Sign.empty() ? ", " : Sign.str();
  std::string Both = A.First ? C + Middle + Own : Own + Middle + C;
  return Sign.empty() ? A.Op + "(" + Both + ")" : Both;
}

bool Transform::isNarrowing() const {
  return Inner && Scale == 1 && Offset == 0 &&
         (Inner->Op == "wrap" || Inner->Op == "wrapu") &&
         Inner->Of.kind() == None;
}

/// The text of what is computed with.
static std::string partText(StringRef Part) {
  if (Part.empty())
    return "x";
  return Part == "element" ? "x[]" : (Part + "(x)").str();
}

std::string Transform::text() const {
  std::string T = Inner ? applicationText(*Inner) : partText(Part);
  if (kind() == None)
    return T;
  if (Inner && !signOf(*Inner).empty() && (Scale != 1 || Offset != 0))
    T = "(" + T + ")";
  if (Scale == -1 && Inner)
    T = "-" + T;
  else if (Scale != 1)
    T = shortest(Scale) + " * " + T;
  if (Offset != 0)
    T += (Offset < 0 ? " - " : " + ") + shortest(std::fabs(Offset));
  return T;
}

json::Value Transform::tree() const {
  json::Value T = "x";
  if (Inner) {
    T = json::Array{Inner->Op, Inner->Of.tree()};
    if (Inner->Constant)
      T.getAsArray()->insert(T.getAsArray()->begin() + (Inner->First ? 1 : 2),
                             *Inner->Constant);
  }
  if (Scale != 1)
    T = json::Array{"*", Scale, std::move(T)};
  if (Offset != 0)
    T = json::Array{"+", std::move(T), Offset};
  return T;
}

//===----------------------------------------------------------------------===//
// Operations of the program
//===----------------------------------------------------------------------===//

std::optional<double> constantNumber(const Value *V, bool Unsigned) {
  while (const auto *Cast = dyn_cast<CastInst>(V))
    V = Cast->getOperand(0);
  if (const auto *Int = dyn_cast<ConstantInt>(V)) {
    if (Int->getBitWidth() > 64)
      return std::nullopt;
    return Unsigned ? static_cast<double>(Int->getZExtValue())
                    : static_cast<double>(Int->getSExtValue());
  }
  const auto *Float = dyn_cast<ConstantFP>(V);
  if (!Float || !Float->getValueAPF().isFinite())
    return std::nullopt;
  APFloat Value = Float->getValueAPF();
  bool Loses;
  Value.convert(APFloat::IEEEdouble(), APFloat::rmNearestTiesToEven, &Loses);
  return Value.convertToDouble();
}

/// Applies `V op C` (`C op V` with \p Left) to \p T; false if that arithmetic
/// is not recorded.
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
    return C != 0;
  case Instruction::FDiv:
    if (Left)
      T.call("/", C, true);
    else
      T.divide(C);
    return C != 0;
  case Instruction::SDiv:
  case Instruction::UDiv:
    T.call("div", C, Left);
    return C != 0;
  case Instruction::SRem:
  case Instruction::URem:
  case Instruction::FRem:
    T.call("rem", C, Left);
    return C != 0;
  case Instruction::Shl:
    T.multiply(std::exp2(C));
    return !Left;
  case Instruction::AShr:
  case Instruction::LShr:
    T.call("shr", C);
    return !Left;
  case Instruction::And:
    T.call("and", C);
    return true;
  case Instruction::Xor: // ~x
    T.multiply(-1);
    T.add(-1);
    return C == -1;
  default:
    return false;
  }
}

/// TPC's name for the mathematical function that \p Call calls: an intrinsic,
/// or a function of the C library with the suffix of its type; empty for all
/// other calls.
static StringRef functionOf(const CallBase &Call) {
  const Function *F = Call.getCalledFunction();
  if (!F || !F->isDeclaration())
    return "";
  StringRef Name = F->getName();
  Type *T = Call.getType();
  if (F->isIntrinsic()) {
    Name = Intrinsic::getBaseName(F->getIntrinsicID());
    Name.consume_front("llvm.");
  } else if (T->isFloatTy()) {
    Name.consume_back("f");
  } else if (T->isX86_FP80Ty() || T->isFP128Ty()) {
    Name.consume_back("l");
  }
  return StringSwitch<StringRef>(Name)
      .Case("fabs", "abs")
      .Case("abs", "abs")
      .Case("labs", "abs")
      .Case("llabs", "abs")
      .Case("fmin", "min")
      .Case("minnum", "min")
      .Case("smin", "min")
      .Case("umin", "min")
      .Case("fmax", "max")
      .Case("maxnum", "max")
      .Case("smax", "max")
      .Case("umax", "max")
      .Case("round", "round")
      .Case("lround", "round")
      .Case("llround", "round")
      .Case("pow", "pow")
      .Case("powi", "pow")
      .Case("fmod", "rem")
      .Case("sqrt", Name)
      .Case("exp", Name)
      .Case("log", Name)
      .Case("log2", Name)
      .Case("log10", Name)
      .Case("sin", Name)
      .Case("cos", Name)
      .Case("tan", Name)
      .Case("asin", Name)
      .Case("acos", Name)
      .Case("atan", Name)
      .Case("floor", Name)
      .Case("ceil", Name)
      .Case("trunc", Name)
      .Default("");
}

/// TPC's name for the arithmetic of \p Opcode with a value that is not
/// constant; empty if that arithmetic is not recorded.
static StringRef operatorOf(unsigned Opcode) {
  switch (Opcode) {
  case Instruction::Add:
  case Instruction::FAdd:
    return "+";
  case Instruction::Sub:
  case Instruction::FSub:
    return "-";
  case Instruction::Mul:
  case Instruction::FMul:
    return "*";
  case Instruction::FDiv:
    return "/";
  case Instruction::SDiv:
  case Instruction::UDiv:
    return "div";
  case Instruction::SRem:
  case Instruction::URem:
  case Instruction::FRem:
    return "rem";
  default:
    return "";
  }
}

static bool takesTwo(StringRef Function) {
  return Function == "pow" || Function == "rem" || Function == "min" ||
         Function == "max";
}

/// \p T combined with \p Other, which is not constant; none if that is no
/// formula any more.
static std::optional<Transform> withVariable(Transform T, StringRef Op,
                                             const Value *Other, bool First,
                                             NameOf Name) {
  if (T.Merged || T.Variables == MaxVariables || Op.empty() ||
      isa<Constant>(Other))
    return std::nullopt;
  std::string Text = Name(Other);
  T.combine(Op, Text.empty() ? "value" : std::move(Text), First);
  return T;
}

/// \p T after \p Call, a call of a mathematical function with \p V.
static std::optional<Transform> applyCall(Transform T, const CallBase &Call,
                                          const Value *V, NameOf Name) {
  StringRef Function = functionOf(Call);
  if (Function.empty())
    return std::nullopt;
  if (!takesTwo(Function)) {
    if (Call.getArgOperand(0) != V)
      return std::nullopt;
    T.call(Function);
    return T;
  }
  bool OnRight = Call.getArgOperand(1) == V;
  bool First = OnRight && (Function == "pow" || Function == "rem");
  const Value *Other = Call.getArgOperand(OnRight ? 0 : 1);
  if (auto C = constantNumber(Other)) {
    T.call(Function, C, First);
    return T;
  }
  return withVariable(std::move(T), Function, Other, First, Name);
}

/// \p Sign times the square of \p T, whichever of the two factors T is.
static void square(Transform &T, int Sign) {
  if (T.Scale < 0)
    T.multiply(-1);
  T.call("pow", 2);
  T.multiply(Sign);
}

/// The text of `A * B`, at least one of which is not constant; empty if one has
/// no name.
static std::string productText(const Value *A, const Value *B, NameOf Name) {
  std::string Text;
  for (const Value *Factor : {A, B}) {
    auto C = constantNumber(Factor);
    std::string Own = C ? shortest(*C) : Name(Factor);
    if (Own.empty())
      return "";
    Text += (Text.empty() ? "" : " * ") + Own;
  }
  return Text;
}

/// \p T after a fused multiply-add.
static std::optional<Transform> applyFma(Transform T, const CallBase &Fma,
                                         const Value *V, int Square,
                                         NameOf Name) {
  const Value *A = Fma.getArgOperand(0), *B = Fma.getArgOperand(1),
              *C = Fma.getArgOperand(2);
  if (C == V) {
    auto Factor = constantNumber(A), Other = constantNumber(B);
    if (Factor && Other) {
      T.add(*Factor * *Other);
      return T;
    }
    return withVariable(std::move(T), "+", Factor ? B : A, /*First=*/false,
                        [&](const Value *) { return productText(A, B, Name); });
  }
  if (Square) {
    square(T, Square);
  } else if (auto Factor = constantNumber(A == V ? B : A)) {
    T.multiply(*Factor);
    if (*Factor == 0)
      return std::nullopt;
  } else if (auto Product = withVariable(std::move(T), "*", A == V ? B : A,
                                         /*First=*/false, Name)) {
    T = std::move(*Product);
  } else {
    return std::nullopt;
  }
  if (auto Term = constantNumber(C)) {
    T.add(*Term);
    return T;
  }
  return withVariable(std::move(T), "+", C, /*First=*/false, Name);
}

Transform withoutNarrowing(Transform T) {
  if (!T.isNarrowing())
    return T;
  Transform Of = T.Inner->Of;
  Of.Width = T.Width;
  return Of;
}

std::optional<Transform> apply(Transform T, const Instruction &I,
                               const Value *V, int Square, NameOf Name) {
  T = withoutNarrowing(std::move(T));
  if (I.getOpcode() == Instruction::FNeg) {
    T.multiply(-1);
    return T;
  }
  if (const auto *Call = dyn_cast<CallBase>(&I)) {
    Intrinsic::ID Id = Call->getIntrinsicID();
    return Id == Intrinsic::fmuladd || Id == Intrinsic::fma
               ? applyFma(std::move(T), *Call, V, Square, Name)
               : applyCall(std::move(T), *Call, V, Name);
  }
  if (!isa<BinaryOperator>(I))
    return std::nullopt;
  if (Square) {
    square(T, Square);
    return T;
  }
  const Value *L = I.getOperand(0), *R = I.getOperand(1);
  unsigned Opcode = I.getOpcode();
  const Value *Other = L == V ? R : L;
  auto C = constantNumber(Other, Opcode == Instruction::UDiv ||
                                     Opcode == Instruction::URem);
  if (!C) {
    bool Commutes = I.isCommutative();
    return withVariable(std::move(T), operatorOf(Opcode), Other,
                        R == V && !Commutes, Name);
  }
  if (!applyConstant(T, Opcode, *C, R == V))
    return std::nullopt;
  return T;
}

/// Corrects \p T if its last step truncated to \p Bits and the result turns out
/// to be read as unsigned.
static void readUnsigned(Transform &T, unsigned Bits) {
  if (!T.Inner || T.Scale != 1 || T.Offset != 0 || T.Inner->Op != "wrap" ||
      *T.Inner->Constant != Bits)
    return;
  unsigned Width = T.Width;
  Transform Of = T.Inner->Of;
  Of.call("wrapu", Bits);
  T = std::move(Of);
  T.Width = Width;
}

Transform applyCast(Transform T, const CastInst &Cast) {
  unsigned From = Cast.getSrcTy()->getScalarSizeInBits();
  unsigned To = Cast.getDestTy()->getScalarSizeInBits();
  switch (Cast.getOpcode()) {
  case Instruction::Trunc:
    // A conversion to one bit makes a truth value, which is a byte in memory.
    if (To > 1 && (!T.Width || T.Width > To)) {
      T.call("wrap", To);
      T.Width = To;
    }
    break;
  case Instruction::FPToSI:
  case Instruction::FPToUI:
    if (!T.Width) {
      T.call("trunc");
      T.Width = To;
    }
    break;
  case Instruction::ZExt:
  case Instruction::UIToFP:
    readUnsigned(T, From);
    [[fallthrough]];
  case Instruction::SExt:
  case Instruction::SIToFP:
    if (!T.Width)
      T.Width = From;
    break;
  default:
    break;
  }
  return T;
}

} // namespace tpc
