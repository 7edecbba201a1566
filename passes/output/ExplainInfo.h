//===- ExplainInfo.h - Paths and blind spots in the static information ----===//
//
// docs/reference/formats.md: `path` of a comparison, `not_exposed`,
// `blind_spots`.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_EXPLAININFO_H
#define TPC_EXPLAININFO_H

#include "results/BlindSpots.h"
#include "results/Explain.h"

#include "llvm/ADT/StringMap.h"
#include "llvm/Support/JSON.h"
#include "llvm/Support/MemoryBuffer.h"

namespace tpc {

/// Reads source files, for the text of a line.
class SourceLines {
public:
  /// Line \p Number of \p Path without leading and trailing blanks; null if it
  /// cannot be read.
  llvm::json::Value line(llvm::StringRef Path, unsigned Number);

private:
  struct File {
    std::unique_ptr<llvm::MemoryBuffer> Text;
    llvm::SmallVector<llvm::StringRef, 0> Lines;
  };
  llvm::StringMap<File> Files;
};

/// A place in the source with comparisons that share a key.
struct SourcePlace {
  std::string File; ///< relative to the source root
  unsigned Line = 0, Column = 0;
  std::string Source; ///< the parameter; empty for a constant
  llvm::SmallVector<const Comparison *, 1> Instances; ///< nearest first
};

/// The places that are listed, and how many there are in all.
struct ListedPlaces {
  llvm::json::Array List;
  size_t Count = 0;
  /// Of each in List, if all are wanted: the function of the analysed program.
  std::vector<const llvm::Function *> In;

  /// True if the next place is listed: there are few, or it is the first of its
  /// kind and parameter. Counts it.
  bool add(bool IsFirst);
};

/// Writes why a module's comparisons are found, and why others are not.
class ExplainInfo {
public:
  ExplainInfo(llvm::Module &M, llvm::ModuleAnalysisManager &AM,
              const Options &Opts);

  llvm::json::Array path(const Comparison &C);

  /// Comparisons with parameters in user code that no exposed statement depends
  /// on. Leaves out the places in \p Comparisons, where another instance of the
  /// same template is exposed.
  /// With \p Every, lists all of them, each once for each function.
  ListedPlaces notExposed(llvm::ArrayRef<SourcePlace> Comparisons,
                          bool Every = false);

  /// The blind spots in user code, and those that have no place; with \p Every
  /// as above.
  ListedPlaces blindSpots(bool Every = false);

private:
  llvm::json::Object placed(const llvm::DILocation *Loc);

  const Options &Opts;
  const ParameterUsage &Usage;
  const ParamCallFinder::Result &Reads;
  const GatheredResults &Gathered;
  const CallGraphResult &Calls;
  Wording Words;
  Explainer Explain;
  SourceLines Lines;
};

} // namespace tpc

#endif // TPC_EXPLAININFO_H
