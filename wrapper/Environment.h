//===- Environment.h - The environment of a compiler command ----*- C++ -*-===//
//
// The installed parts of TPC, the programs, the variables of the environment
// and the project of the working folder.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_WRAPPER_ENVIRONMENT_H
#define TPC_WRAPPER_ENVIRONMENT_H

#include <filesystem>
#include <string>
#include <vector>

namespace tpc {

/// The file share/tpc/flags, which tpc.cmake reads too: the words of the flags
/// by where they are added, with all placeholders filled in.
struct Flags {
  std::vector<std::string> Compile;
  std::vector<std::string> Accept; ///< make clang accept what gcc accepts
  std::vector<std::string> Link;
  std::vector<std::string> Linker; ///< for the linker
  std::vector<std::string> Log;    ///< for the linker, before all libraries
  std::vector<std::string> Last;   ///< for the linker, at the end
};

struct Environment {
  std::filesystem::path Prefix;
  std::filesystem::path WorkingFolder;
  std::filesystem::path SourceRoot;
  std::filesystem::path StaticInfo; ///< TPC_STATIC_INFO; empty if not set
  std::string Package;
  std::string Rules;      ///< absolute; empty if not set
  std::string Profile;    ///< empty if not set
  std::string MaxSeconds; ///< only digits; empty if not set
  std::string MaxMemory;  ///< only digits; empty if not set
  std::string Lld;        ///< empty if not found
  bool Constants = false;
  bool IsDisabled = false;
  /// The first part that TPC needs and that is missing; empty if there is none.
  std::string Missing;
  /// Errors in the variables, one line each.
  std::vector<std::string> Complaints;
  Flags Added;

  static Environment read(const std::filesystem::path &Self);
};

/// The release of clang and LLVM: TPC_CLANG_VERSION, or the one that the passes
/// were built for.
std::string clangVersion();

/// The first program \p Name on PATH that is not a link to \p Self, or the one
/// in the folder of the release. Empty if there is none.
std::string findProgram(const std::string &Name,
                        const std::filesystem::path &Self);

} // namespace tpc

#endif
