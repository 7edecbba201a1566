//===- Plan.h - What is added to a compiler's command -----------*- C++ -*-===//
#ifndef TPC_WRAPPER_PLAN_H
#define TPC_WRAPPER_PLAN_H

#include "Arguments.h"
#include "Environment.h"

#include <string>
#include <vector>

namespace tpc {

struct Plan {
  std::vector<std::string> Added; ///< flags behind the caller's
  std::vector<std::string>
      Dropped;         ///< flags of the caller's that no other undoes
  std::string Warning; ///< why nothing is reported; empty where all is well
};

/// What TPC adds to a command that asks for \p Asked; what does not go together
/// with it is compiled as clang would, and only linked by lld.
Plan planFor(const Arguments &Asked, const Environment &Around);

/// Name of a link unit by the file that is linked: without folder, without
/// "lib" and ".so" with what follows it.
std::string linkUnitName(const std::string &Output);

/// True where a configure script, CMake or Meson tries what the compiler can:
/// nobody's program, whose objects and words are looked at.
bool isProbe(const Arguments &Asked, const std::filesystem::path &Folder);

} // namespace tpc

#endif
