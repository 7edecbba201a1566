//===- Interface.h - What a link takes from a shared library --------------===//
#ifndef TPC_RELINK_INTERFACE_H
#define TPC_RELINK_INTERFACE_H

#include "llvm/ADT/StringRef.h"

#include <cstdint>
#include <optional>
#include <vector>

namespace tpc {

/// The parts of a shared library that decide how others are linked with it.
/// Names are hashed.
struct Interface {
  /// Of its name and the symbols that it defines.
  uint64_t Digest = 0;
  std::vector<uint64_t> Defined;   ///< sorted
  std::vector<uint64_t> Undefined; ///< sorted
};

/// The interface of the file at \p Path; none if it is no shared library of a
/// 64-bit machine.
std::optional<Interface> interfaceOf(llvm::StringRef Path);

} // namespace tpc

#endif // TPC_RELINK_INTERFACE_H
