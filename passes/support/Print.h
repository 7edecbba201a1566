//===- Print.h - Prints places --------------------------------------------===//
#ifndef TPC_PRINT_H
#define TPC_PRINT_H

#include "llvm/IR/DebugInfoMetadata.h"
#include "llvm/IR/DebugLoc.h"
#include "llvm/IR/Instruction.h"

#include <string>

namespace tpc {

/// ` at line:column`, or an empty string if \p I has no debug location.
inline std::string place(const llvm::Instruction &I) {
  const llvm::DebugLoc &Loc = I.getDebugLoc();
  if (!Loc)
    return "";
  return " at " + std::to_string(Loc.getLine()) + ":" +
         std::to_string(Loc.getCol());
}

} // namespace tpc

#endif // TPC_PRINT_H
