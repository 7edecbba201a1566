//===- Manifest.h - What is needed to link a unit again -------------------===//
//
// A process is analysed as one program, from the bitcode of all of its link
// units, and each unit is then linked again. The manifest of a unit says what
// both need: docs/reference/formats.md.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_MANIFEST_H
#define TPC_MANIFEST_H

#include "Options.h"
#include "plan/CommandLine.h"

#include "llvm/Support/Error.h"
#include "llvm/Support/JSON.h"

namespace tpc {

/// The command line of this link, understood.
LinkCommand ownLinkCommand();

/// True if the linker takes a shared library for \p In whose path begins with
/// \p Beginning; \p Folders are those in which it looks for libraries.
bool isSharedLibraryBelow(const LinkInput &In,
                          llvm::ArrayRef<std::string> Folders,
                          llvm::StringRef Beginning);

/// The manifest of the link that this process does.
llvm::json::Object describeLink(const Options &Opts);

/// Writes \p V to a temporary file beside \p Path and renames that.
llvm::Error writeJsonText(const llvm::json::Value &V, llvm::StringRef Path);

} // namespace tpc

#endif // TPC_MANIFEST_H
