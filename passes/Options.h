//===- Options.h - What a build tells the plugin --------------------------===//
#ifndef TPC_OPTIONS_H
#define TPC_OPTIONS_H

#include "support/Guard.h"
#include "support/SourcePath.h"

#include "llvm/ADT/DenseMap.h"
#include "llvm/ADT/StringRef.h"
#include "llvm/IR/DebugInfoMetadata.h"
#include "llvm/IR/PassManager.h"

#include <optional>
#include <string>
#include <vector>

namespace tpc {

/// The options of one link.
struct Options {
  std::string LinkUnit;   ///< target's name; else the file name of `-o`
  std::string Package;    ///< name of the CMake project
  std::string SourceRoot; ///< folder that reported files are relative to
  std::string StaticInfo; ///< where the JSON goes; empty: nowhere
  std::string Profile;    ///< profile of the rules
  std::vector<std::string> RuleFiles; ///< the user's own tables
  std::vector<std::string> Excluded;  ///< folders that are not the user's
  bool Analyse = true;                ///< else the unit is only optimised
  bool Instrument = true;
  bool Constants = false; ///< report comparisons with constants, too
  bool Prelink = true;
  unsigned MaxSeconds = 0; ///< of the analysis; 0 is no limit
  unsigned MaxMemory = 0;  ///< of the analysis, in MiB; 0 is no limit
  Failure InjectFailure = Failure::None;
  Failure InjectLateFailure = Failure::None;

  /// True where \p Path (absolute) is one of the user's own sources: it is
  /// below none of the excluded folders, or the source root is nearer to it.
  bool isUserSource(llvm::StringRef Path) const;

  /// \p Path relative to SourceRoot where it is below it, else unchanged.
  std::string relative(llvm::StringRef Path) const;

  /// No pass changes the options.
  bool invalidate(llvm::Module &, const llvm::PreservedAnalyses &,
                  llvm::ModuleAnalysisManager::Invalidator &) {
    return false;
  }
};

/// The options of this process: from its command line (`-mllvm -tpc-*`) and,
/// for the link unit's name, from the linker's own `-o`. A manager for a copy
/// of the module is given the options of the module that was copied.
class OptionsAnalysis : public llvm::AnalysisInfoMixin<OptionsAnalysis> {
public:
  using Result = Options;
  OptionsAnalysis() = default;
  explicit OptionsAnalysis(Options Known) : Known(std::move(Known)) {}
  Result run(llvm::Module &, llvm::ModuleAnalysisManager &);

private:
  friend llvm::AnalysisInfoMixin<OptionsAnalysis>;
  static llvm::AnalysisKey Key;
  std::optional<Options> Known;
};

/// Whose code something is, by the file that its debug information names.
class UserSources {
public:
  explicit UserSources(const Options &Opts) : Opts(Opts) {}
  /// True where \p F is the user's own; false without debug information.
  bool has(const llvm::Function &F);
  bool has(const llvm::DILocation *Loc);

private:
  bool has(const llvm::DIFile *File);
  const Options &Opts;
  llvm::DenseMap<const llvm::DIFile *, bool> Known;
};

/// The absolute path of the file of \p Loc, without `.` and `..`; empty
/// where there is no location.
std::string pathOf(const llvm::DILocation *Loc);

} // namespace tpc

#endif // TPC_OPTIONS_H
