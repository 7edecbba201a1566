//===- Registers.h - Numbers that share a register ------------------------===//
//
// A small object is passed and returned as one number or as a pair, and bit
// fields share a word. This file tracks which bits of a value hold the followed
// number through shifts, masks and casts.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_REGISTERS_H
#define TPC_REGISTERS_H

#include "llvm/IR/Instructions.h"

#include <optional>

namespace tpc {

/// The bits of a value, as it is in memory, that hold a number.
struct Bits {
  unsigned Low, Size;
};

/// What an instruction does to a number in a register.
struct Repacked {
  enum KindTy {
    None,  ///< it is not such an instruction, or the number is not preserved
    Gone,  ///< the number is not in the result
    Whole, ///< the result is the number
    Part,  ///< the number is in some bits of the result
  };
  KindTy Kind;
  Bits In = {0, 0}; ///< for Part
};

/// What the user of \p U does to it. The number is in the bits \p In or,
/// without \p In, is all of it.
Repacked repack(const llvm::Use &U, std::optional<Bits> In);

} // namespace tpc

#endif // TPC_REGISTERS_H
