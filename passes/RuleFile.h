//===- RuleFile.h - Reads a file of rules ---------------------------------===//
//
// Reads rows from JSON. rules/rules.schema.json defines the format. An error
// names the file and the place in it.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_RULEFILE_H
#define TPC_RULEFILE_H

#include "Rules.h"

namespace tpc {

struct RuleFile {
  std::vector<Rule> Rows;
  std::vector<std::string> Opaque, Kept, Counting, Destroying,
      Silent; ///< prefixes of names
  std::vector<std::string> ContainerClasses, ReadingMethods, Transparent;
  /// Functions that override one of another library expose something, but not
  /// those of classes that begin with one of these names.
  bool ShowsOverrides = false;
  std::vector<std::string> KeptOverrides, Tools;
};

/// The rows of \p Text that belong to \p Profile. \p Origin is the file name
/// shown in errors.
llvm::Expected<RuleFile> parseRules(llvm::StringRef Text,
                                    llvm::StringRef Origin,
                                    llvm::StringRef Profile);

} // namespace tpc

#endif // TPC_RULEFILE_H
