//===- SourcePath.h - Paths of source files -------------------------------===//
#ifndef TPC_SOURCEPATH_H
#define TPC_SOURCEPATH_H

#include "llvm/ADT/SmallString.h"
#include "llvm/IR/DebugInfoMetadata.h"
#include "llvm/Support/Path.h"

#include <string>

namespace tpc {

/// The absolute path of \p File, without `.` and `..`; empty if \p File is
/// null.
inline std::string pathOf(const llvm::DIFile *File) {
  if (!File)
    return "";
  llvm::SmallString<256> Path(File->getFilename());
  if (!llvm::sys::path::is_absolute(Path)) {
    Path = File->getDirectory();
    llvm::sys::path::append(Path, File->getFilename());
  }
  llvm::sys::path::remove_dots(Path, /*remove_dot_dot=*/true);
  return std::string(Path);
}

} // namespace tpc

#endif // TPC_SOURCEPATH_H
