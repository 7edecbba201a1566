//===- CommandLine.h - What the linker was asked --------------------------===//
//
// The linker tells a plugin nothing of its command line, so it is read from the
// system. Options are those of GNU ld, as lld understands them.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_COMMANDLINE_H
#define TPC_COMMANDLINE_H

#include "llvm/ADT/ArrayRef.h"
#include "llvm/ADT/StringRef.h"

#include <string>
#include <vector>

namespace tpc {

/// The words of this process's command line, with response files in place of
/// `@file`: a compiler deletes those when the link is done. Empty if the system
/// does not tell.
std::vector<std::string> ownCommandLine();

/// A file of a link, or a library that the linker looks for.
struct LinkInput {
  std::string Name;          ///< as given: a path, or what follows -l
  bool IsLibrary = false;    ///< given as -l
  bool WholeArchive = false; ///< behind --whole-archive
  bool AsNeeded = false;     ///< behind --as-needed
  bool Static = false;       ///< behind -Bstatic
  bool Lazy = false;         ///< between --start-lib and --end-lib
};

struct LinkCommand {
  std::string Output = "a.out";
  std::string SoName; ///< empty for none
  bool IsShared = false;
  std::vector<LinkInput> Inputs; ///< in the order of the command
  std::vector<std::string> LibraryFolders;
  std::vector<std::string> RunPaths;
};

/// \p Words without the linker's own name, understood.
LinkCommand readLinkCommand(llvm::ArrayRef<std::string> Words);

} // namespace tpc

#endif // TPC_COMMANDLINE_H
