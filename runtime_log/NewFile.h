//===- NewFile.h - Creates a file of reports ------------------------------===//
//
// Where the file is created and what it is called: the folder in the settings,
// then the node or the program, the process and the time. The file gets its
// final name only once it can be read.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_NEWFILE_H
#define TPC_NEWFILE_H

#include "Config.h"

#include <optional>
#include <string>

namespace tpc {

/// What the files of one ring have in common, and the number of the next one.
struct SegmentName {
  int64_t Began = 0; ///< in seconds since 1970
  uint32_t Next = 1;
};

struct NewFile {
  std::string Path;
  int Descriptor;
  uint32_t Segment = 0; ///< its number in a ring

  /// Creates an empty file in the folder of \p C, with `.new` behind its name
  /// for now; if that fails, returns none and sets \p Why. \p Of: it is of this
  /// ring, unless that is null.
  static std::optional<NewFile> create(const Config &C, SegmentName *Of,
                                       std::string &Why);
  /// Gives it its final name; if that fails, returns false and sets \p Why.
  bool publish(std::string &Why) const;
  /// Deletes and closes it instead.
  void discard() const;
};

/// The text of \p Error, an errno.
std::string errorText(int Error);

/// The path of the running program; empty if it is not known.
std::string programPath();

} // namespace tpc

#endif // TPC_NEWFILE_H
