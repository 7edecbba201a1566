//===- Checksum.h - Whether two functions have the same body --------------===//
#ifndef TPC_CHECKSUM_H
#define TPC_CHECKSUM_H

#include "llvm/IR/Function.h"

#include <string>

namespace tpc {

/// A number, as text, of what \p F does and on which lines. It is the same in
/// every module that \p F is linked into, for every copy of \p F that serves
/// one call, and for a call of a function by either of its names.
std::string checksumOf(const llvm::Function &F);

/// The name of \p F in the source, which no linker changes; that in the code if
/// there is no debug information.
llvm::StringRef sourceNameOf(const llvm::Function &F);

} // namespace tpc

#endif // TPC_CHECKSUM_H
