//===- Numbers.h - The numbers of instructions ----------------------------===//
//
// An instruction has the same number in each copy of its function, whether
// variables are described by instructions or beside them.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_NUMBERS_H
#define TPC_NUMBERS_H

#include "llvm/ADT/STLExtras.h"
#include "llvm/IR/InstIterator.h"
#include "llvm/IR/Instruction.h"

namespace tpc {

/// The instructions of \p F (const or not) that have numbers, in their order.
template <typename FunctionT> auto numberedInstructions(FunctionT &F) {
  return llvm::make_filter_range(
      llvm::instructions(F),
      [](const llvm::Instruction &I) { return !I.isDebugOrPseudoInst(); });
}

} // namespace tpc

#endif // TPC_NUMBERS_H
