//===- Registers.h - Numbers that share a register ------------------------===//
//
// A small object is handed over and returned as one number or as a pair, and
// bit fields share their word. Which bits of a value the number is that is
// followed, and what shifts, masks and casts make of that.
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

/// What an instruction makes of a number in a register.
struct Repacked {
  enum KindTy {
    None,  ///< it is not such an instruction, or the number is not kept
    Gone,  ///< the number is not in what it gives
    Whole, ///< what it gives is the number
    Part,  ///< the number is in some bits of what it gives
  };
  KindTy Kind;
  Bits In = {0, 0}; ///< of Part
};

/// What the user of \p U makes of it, of which \p In, or else all of it, is the
/// number.
Repacked repack(const llvm::Use &U, std::optional<Bits> In);

} // namespace tpc

#endif // TPC_REGISTERS_H
