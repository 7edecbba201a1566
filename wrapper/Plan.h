//===- Plan.h - What is added to a compiler command -------------*- C++ -*-===//
#ifndef TPC_WRAPPER_PLAN_H
#define TPC_WRAPPER_PLAN_H

#include "Arguments.h"
#include "Environment.h"

#include <string>
#include <vector>

namespace tpc {

struct Plan {
  std::vector<std::string> First; ///< flags to add before those of the caller
  std::vector<std::string> Added; ///< flags to add after those of the caller
  /// Flags of the caller that no other flag undoes.
  std::vector<std::string> Dropped;
  std::string Warning; ///< why nothing is reported; empty if all is well
};

/// What TPC adds to a command that asks for \p Asked. If TPC does not support
/// it, it is compiled as clang would, and only linked by lld.
Plan planFor(const Arguments &Asked, const Environment &Around);

/// The name of a link unit from the file that is linked: without the folder,
/// "lib", and ".so" with anything after it.
std::string linkUnitName(const std::string &Output);

/// True if a configure script, CMake or Meson checks what the compiler can do:
/// the objects belong to no program, and the check reads the output.
bool isProbe(const Arguments &Asked, const std::filesystem::path &Folder);

} // namespace tpc

#endif
