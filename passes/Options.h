//===- Options.h - The options of the plugin ------------------------------===//
#ifndef TPC_OPTIONS_H
#define TPC_OPTIONS_H

#include "support/Guard.h"
#include "support/SourcePath.h"

#include "llvm/ADT/DenseMap.h"
#include "llvm/ADT/StringRef.h"
#include "llvm/ADT/Twine.h"
#include "llvm/IR/DebugInfoMetadata.h"
#include "llvm/IR/PassManager.h"

#include <optional>
#include <string>
#include <vector>

namespace tpc {

/// The options of one link.
struct Options {
  std::string LinkUnit; ///< name of the target; otherwise the file name of `-o`
  bool SharedLibrary = false; ///< the linker makes one
  std::string Package;        ///< name of the CMake project
  std::string SourceRoot;     ///< folder that reported files are relative to
  std::string StaticInfo;     ///< where the JSON is written; empty: nowhere
  std::string Profile;        ///< profile of the rules
  std::vector<std::string> RuleFiles; ///< the user's own tables
  std::vector<std::string> Excluded;  ///< folders that are not the user's
  bool Analyse = true;                ///< if false, the unit is only optimised
  bool Instrument = true;
  bool Constants = false; ///< also report comparisons with constants
  bool Prelink = true;
  std::string Manifest; ///< where what this link needs is written, if anywhere
  std::string PlanOut;  ///< where the plan of the findings is written, if so
  std::vector<std::string> Plans; ///< findings to insert without an analysis
  bool KeepAbsolute = false;      ///< relative() changes nothing
  unsigned MaxSeconds = 0;        ///< for the analysis; 0: no limit
  unsigned MaxMemory = 0;         ///< for the analysis, in MiB; 0: no limit
  Failure InjectFailure = Failure::None;
  Failure InjectLateFailure = Failure::None;

  /// True if \p Path (absolute) is user code: it is in no excluded folder, or
  /// the source root is the longer prefix, and is not installed with ROS.
  bool isUserSource(llvm::StringRef Path) const;

  /// The name of the link unit with its package, if that is known.
  std::string fullName() const {
    return Package.empty() ? LinkUnit : Package + "/" + LinkUnit;
  }

  /// \p Path relative to SourceRoot if it is below it; otherwise \p Path.
  std::string relative(llvm::StringRef Path) const;

  /// No pass changes the options.
  bool invalidate(llvm::Module &, const llvm::PreservedAnalyses &,
                  llvm::ModuleAnalysisManager::Invalidator &) {
    return false;
  }
};

/// The options of this process. They come from its command line (`-mllvm
/// -tpc-*`), the name of the link unit also from the linker's `-o`. The manager
/// of a copied module gets the options of the original module.
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

/// Decides by the file in the debug information whether code is user code.
class UserSources {
public:
  explicit UserSources(const Options &Opts) : Opts(Opts) {}
  /// True if \p F is user code; false without debug information.
  bool has(const llvm::Function &F);
  bool has(const llvm::DILocation *Loc);
  bool has(const llvm::DIFile *File);

private:
  const Options &Opts;
  llvm::DenseMap<const llvm::DIFile *, bool> Known;
};

/// Prints one line of warning about the link unit.
void warn(const Options &Opts, const llvm::Twine &Text);

/// The absolute path of the file of \p Loc, without `.` and `..`; empty if
/// there is no location.
std::string pathOf(const llvm::DILocation *Loc);

} // namespace tpc

#endif // TPC_OPTIONS_H
