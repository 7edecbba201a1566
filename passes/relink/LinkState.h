//===- LinkState.h - What the result of a link depends on -----------------===//
#ifndef TPC_RELINK_LINKSTATE_H
#define TPC_RELINK_LINKSTATE_H

#include "llvm/ADT/ArrayRef.h"
#include "llvm/ADT/StringRef.h"
#include "llvm/Support/Chrono.h"

#include <string>
#include <vector>

namespace tpc {

/// A command that links a unit with the passes. Paths are as in the command.
struct LinkCommandLine {
  std::vector<std::string> Words;
  std::string Output, Manifest, StaticInfo, Plans;
  std::string Dependencies;       ///< where the linker lists what it read
  std::vector<std::string> Tools; ///< the linker, the passes, and their files

  /// True if this file knows all that the command reads and writes.
  bool isKnown() const {
    return !Output.empty() && !Manifest.empty() && !StaticInfo.empty() &&
           !Plans.empty();
  }
  /// The file with the state of the last link.
  std::string stateFile() const { return Manifest + ".state"; }
  /// The file that is written anew when other plans are about the unit.
  std::string planFile() const { return Plans + "/changed"; }
};

LinkCommandLine readCommand(llvm::ArrayRef<std::string> Words);

/// True if the last run of \p Command left what another would.
bool isUpToDate(const LinkCommandLine &Command);

/// Records a run of \p Command that began at \p Start and succeeded, unless it
/// is to be run again, or something that it read has changed since.
void recordState(const LinkCommandLine &Command, llvm::sys::TimePoint<> Start);

} // namespace tpc

#endif // TPC_RELINK_LINKSTATE_H
