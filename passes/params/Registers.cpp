//===- Registers.cpp ------------------------------------------------------===//
#include "params/Registers.h"

#include "llvm/Analysis/ValueTracking.h"
#include "llvm/IR/Module.h"
#include "llvm/IR/PatternMatch.h"

using namespace llvm;
using namespace llvm::PatternMatch;

namespace tpc {

/// The number is in the bits \p In of a value of \p Width bits.
static Repacked at(Bits In, unsigned Width) {
  if (In.Low == 0 && In.Size == Width)
    return {Repacked::Whole};
  return {Repacked::Part, In};
}

/// True if \p V is only combined with other numbers.
static bool isOnlyJoined(const Value &V) {
  return !V.use_empty() && all_of(V.users(), [](const User *U) {
    return match(U, m_Or(m_Value(), m_Value()));
  });
}

/// True if \p V is only moved to its place beside other numbers.
static bool isOnlyPlaced(const Value &V) {
  return !V.use_empty() && all_of(V.users(), [](const User *U) {
    return match(U, m_Or(m_Value(), m_Value())) ||
           (match(U, m_Shl(m_Value(), m_ConstantInt())) && isOnlyJoined(*U));
  });
}

static KnownBits bitsOf(const Value *V, const Instruction &At) {
  return computeKnownBits(V, At.getModule()->getDataLayout());
}

/// The mask that \p I, an `and`, applies; null if it is not constant.
static const APInt *maskOf(const Instruction &I) {
  const APInt *Mask;
  return match(&I, m_And(m_Value(), m_APInt(Mask))) ? Mask : nullptr;
}

/// The number itself is an operand of \p I, which puts it into place:
/// unchanged, into the low bits, or above others.
static Repacked place(const Instruction &I, const Use &U) {
  const Value *V = U.get();
  unsigned Width = V->getType()->getIntegerBitWidth();
  switch (I.getOpcode()) {
  case Instruction::And: {
    const APInt *Mask = maskOf(I);
    if (!Mask || Width == 1)
      return {Repacked::None};
    // All bits that the number can have, or all that its place can hold.
    bool IsField = Mask->isMask() && isOnlyPlaced(I);
    return {IsField || (~bitsOf(V, I).Zero).isSubsetOf(*Mask) ? Repacked::Whole
                                                              : Repacked::None};
  }
  case Instruction::Or: {
    KnownBits Own = bitsOf(V, I),
              Other = bitsOf(I.getOperand(1 - U.getOperandNo()), I);
    // A constant flag is arithmetic of the program itself.
    if (Width == 1 || Other.isConstant() || !(~Own.Zero).isSubsetOf(Other.Zero))
      return {Other.isZero() ? Repacked::Whole : Repacked::None};
    return at({0, Own.countMaxActiveBits()}, Width);
  }
  case Instruction::Shl: {
    const APInt *By;
    if (!match(&I, m_Shl(m_Value(), m_APInt(By))) || !isOnlyJoined(I) ||
        By->uge(Width))
      return {Repacked::None};
    unsigned Low = By->getZExtValue();
    unsigned Size = std::min(bitsOf(V, I).countMaxActiveBits(), Width - Low);
    return at({Low, Size}, Width);
  }
  default:
    return {Repacked::None};
  }
}

/// What the shift \p I does to the number in \p In.
static Repacked shift(const Instruction &I, Bits In, unsigned Width) {
  const auto *By = dyn_cast<ConstantInt>(I.getOperand(1));
  if (!By || By->getValue().uge(Width))
    return {Repacked::None};
  unsigned N = By->getZExtValue();
  if (I.getOpcode() == Instruction::Shl) {
    if (In.Low + N >= Width)
      return {Repacked::Gone};
    return In.Low + In.Size + N <= Width ? at({In.Low + N, In.Size}, Width)
                                         : Repacked{Repacked::None};
  }
  if (In.Low + In.Size <= N)
    return {Repacked::Gone};
  if (In.Low < N)
    return {Repacked::None};
  // The number that was in the top bits is now the whole value.
  if (In.Low == N && In.Low + In.Size == Width)
    return {Repacked::Whole};
  return at({In.Low - N, In.Size}, Width);
}

/// What the mask of \p I leaves of the number in \p In.
static Repacked mask(const Instruction &I, Bits In, unsigned Width) {
  const APInt *Mask = maskOf(I);
  if (!Mask || In.Low + In.Size > Width)
    return {Repacked::None};
  APInt Own = APInt::getBitsSet(Width, In.Low, In.Low + In.Size);
  if (!Own.intersects(*Mask))
    return {Repacked::Gone};
  if (!Own.isSubsetOf(*Mask))
    return {Repacked::None};
  return In.Low == 0 && *Mask == Own ? Repacked{Repacked::Whole}
                                     : Repacked{Repacked::Part, In};
}

/// What the user of \p U does to the number in the bits \p In of an integer.
static Repacked take(const Instruction &I, const Use &U, Bits In) {
  unsigned Width = U->getType()->getIntegerBitWidth();
  switch (I.getOpcode()) {
  case Instruction::And:
    return mask(I, In, Width);
  case Instruction::Or: {
    KnownBits Other = bitsOf(I.getOperand(1 - U.getOperandNo()), I);
    bool IsFree = In.Low + In.Size <= Width &&
                  APInt::getBitsSet(Width, In.Low, In.Low + In.Size)
                      .isSubsetOf(Other.Zero);
    return IsFree ? Repacked{Repacked::Part, In} : Repacked{Repacked::None};
  }
  case Instruction::Shl:
  case Instruction::LShr:
  case Instruction::AShr:
    return shift(I, In, Width);
  case Instruction::Trunc: {
    unsigned To = I.getType()->getIntegerBitWidth();
    if (In.Low >= To)
      return {Repacked::Gone};
    // A truth value is one bit, but a byte in memory.
    if (In.Low == 0 && To == 1)
      return {Repacked::Whole};
    return In.Low + In.Size <= To ? at(In, To) : Repacked{Repacked::None};
  }
  case Instruction::ZExt:
  case Instruction::SExt:
    return {Repacked::Part, In};
  case Instruction::BitCast:
    return at(In, Width);
  default:
    return {Repacked::None};
  }
}

/// The bits of the element of a struct or vector that \p I inserts or extracts;
/// none if the index is not constant, or names an element of an element.
static std::optional<Bits> partOf(const Instruction &I) {
  const DataLayout &Layout = I.getModule()->getDataLayout();
  const auto *Insert = dyn_cast<InsertValueInst>(&I);
  const auto *Extract = dyn_cast<ExtractValueInst>(&I);
  if (Insert || Extract) {
    auto *T = dyn_cast<StructType>(I.getOperand(0)->getType());
    ArrayRef<unsigned> Way =
        Insert ? Insert->getIndices() : Extract->getIndices();
    if (!T || Way.size() != 1)
      return std::nullopt;
    return Bits{static_cast<unsigned>(
                    Layout.getStructLayout(T)->getElementOffsetInBits(Way[0])),
                static_cast<unsigned>(
                    Layout.getTypeStoreSizeInBits(T->getElementType(Way[0])))};
  }
  const auto *Number =
      dyn_cast<ConstantInt>(I.getOperand(isa<InsertElementInst>(I) ? 2 : 1));
  auto *T = dyn_cast<FixedVectorType>(I.getOperand(0)->getType());
  if (!T || !Number || Number->getValue().uge(T->getNumElements()))
    return std::nullopt;
  unsigned Size = T->getScalarSizeInBits();
  return Bits{static_cast<unsigned>(Number->getZExtValue()) * Size, Size};
}

static bool overlap(Bits A, Bits B) {
  return A.Low < B.Low + B.Size && B.Low < A.Low + A.Size;
}

Repacked repack(const Use &U, std::optional<Bits> In) {
  const auto *I = cast<Instruction>(U.getUser());
  bool IsInsert = isa<InsertValueInst>(I) || isa<InsertElementInst>(I);
  if (IsInsert || isa<ExtractValueInst>(I) || isa<ExtractElementInst>(I)) {
    std::optional<Bits> Own = partOf(*I);
    if (!Own)
      return {Repacked::None};
    if (IsInsert && U.getOperandNo() == 1)
      return {Repacked::Part, In ? Bits{Own->Low + In->Low, In->Size} : *Own};
    if (!In || overlap(*In, *Own) == IsInsert)
      return {Repacked::Gone};
    if (IsInsert)
      return {Repacked::Part, *In};
    if (In->Low < Own->Low || In->Low + In->Size > Own->Low + Own->Size)
      return {Repacked::None};
    return at({In->Low - Own->Low, In->Size}, Own->Size);
  }
  if (!U->getType()->isIntegerTy())
    return {Repacked::None};
  return In ? take(*I, U, *In) : place(*I, U);
}

} // namespace tpc
