//===- RuleFile.h - One file of rules -------------------------------------===//
//
// From JSON to rows. The form is that of rules/rules.schema.json; what does not
// keep to it is an error that names the file and the place in it.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_RULEFILE_H
#define TPC_RULEFILE_H

#include "Rules.h"

namespace tpc {

struct RuleFile {
  std::vector<Rule> Rows;
  std::vector<std::string> Opaque, Kept, Counting; ///< beginnings of names
  std::vector<std::string> ContainerClasses, ReadingMethods, Transparent;
};

/// The rows of \p Text that belong to \p Profile. \p Origin is the file's name,
/// for errors.
llvm::Expected<RuleFile> parseRules(llvm::StringRef Text,
                                    llvm::StringRef Origin,
                                    llvm::StringRef Profile);

} // namespace tpc

#endif // TPC_RULEFILE_H
