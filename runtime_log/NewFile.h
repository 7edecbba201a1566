//===- NewFile.h - A file of reports that is being made -------------------===//
//
// Where the file goes and what it is called: the folder that the settings name,
// then the node or the program, the process and the time. The file has its name
// only once it can be read.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_NEWFILE_H
#define TPC_NEWFILE_H

#include "Config.h"

#include <optional>
#include <string>

namespace tpc {

struct NewFile {
  std::string Path;
  int Descriptor;

  /// Makes an empty file, which is called `Path.new` for now, in the folder of
  /// \p C; none, with \p Why, where that cannot be.
  static std::optional<NewFile> create(const Config &C, std::string &Why);
  /// Gives it its name; false, with \p Why, where that cannot be.
  bool publish(std::string &Why) const;
  /// Deletes and closes it instead.
  void discard() const;
};

/// The text of \p Error, an errno.
std::string errorText(int Error);

/// The path of the running program; empty where it is not known.
std::string programPath();

} // namespace tpc

#endif // TPC_NEWFILE_H
