//===- Keys.h - The keys of comparisons and reads -------------------------===//
//
// A key is a UUID of version 5 that survives a rebuild. It names the link unit
// that it is in, so the parts that are known without one are kept as well: a
// function of a header is in several units, with another key in each.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_KEYS_H
#define TPC_KEYS_H

#include "Options.h"

namespace tpc {

/// What a key is made of, beside the package and the link unit.
struct KeyParts {
  std::string Path; ///< absolute
  std::string Function;
  unsigned Line = 0, Column = 0;
  std::string What; ///< the parameter or the constant

  /// The parts of what \p What is about at \p Where.
  static KeyParts of(const llvm::DILocation &Where, llvm::StringRef What);
};

/// What the key of a comparison is the UUID of, unless it is the second at its
/// place.
std::string nameOfComparison(const KeyParts &Parts, const Options &Opts);

/// The key of the comparison \p Ordinal (from 0) of those at one place with one
/// parameter, whose nameOfComparison() is \p Name.
std::string comparisonKey(std::string Name, size_t Ordinal);

std::string readKey(const KeyParts &Parts, const Options &Opts);

} // namespace tpc

#endif // TPC_KEYS_H
