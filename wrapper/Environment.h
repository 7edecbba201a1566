//===- Environment.h - What is around a compiler's command ------*- C++ -*-===//
//
// The installed parts of TPC, the programs, the variables of the environment
// and the project that the working folder belongs to.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_WRAPPER_ENVIRONMENT_H
#define TPC_WRAPPER_ENVIRONMENT_H

#include <filesystem>
#include <string>
#include <vector>

namespace tpc {

/// The file share/tpc/flags, which tpc.cmake reads as well: a flag's words by
/// where it belongs, with the places filled in.
struct Flags {
  std::vector<std::string> Compile;
  std::vector<std::string> Accept; ///< clang takes what gcc does
  std::vector<std::string> Link;
  std::vector<std::string> Linker; ///< to the linker
  std::vector<std::string> Last;   ///< to the linker, at the end
};

struct Environment {
  std::filesystem::path Prefix;
  std::filesystem::path WorkingFolder;
  std::filesystem::path SourceRoot;
  std::filesystem::path StaticInfo; ///< TPC_STATIC_INFO; empty where not set
  std::string Package;
  std::string Rules;      ///< absolute; empty where not set
  std::string Profile;    ///< empty where not set
  std::string MaxSeconds; ///< empty where not set, digits else
  std::string MaxMemory;  ///< the same
  std::string Lld;        ///< empty where it is not there
  bool Constants = false;
  bool IsDisabled = false;
  /// What is not there that TPC needs; empty where all is.
  std::string Missing;
  /// What is wrong with the variables; one line each.
  std::vector<std::string> Complaints;
  Flags Added;

  static Environment read(const std::filesystem::path &Self);
};

/// The release of clang and LLVM: TPC_CLANG_VERSION, else the one that the
/// passes were built for.
std::string clangVersion();

/// The first program \p Name on PATH that is not \p Self by another name; else
/// in the folder of the release. Empty where there is none.
std::string findProgram(const std::string &Name,
                        const std::filesystem::path &Self);

} // namespace tpc

#endif
