//===- StaticInfo.h - The static information of a link unit ---------------===//
//
// One JSON file per link unit: docs/reference/formats.md.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_STATICINFO_H
#define TPC_STATICINFO_H

#include "Options.h"
#include "results/GatherResults.h"

#include "llvm/Support/Error.h"
#include "llvm/Support/JSON.h"

namespace tpc {

/// The contents of a link unit's file. The comparisons are stored as text
/// because there are many.
struct UnitInfo {
  llvm::json::Object Fields;
  std::vector<std::string> Comparisons;
};

/// The contents of the file for the analysed module \p M.
UnitInfo describe(llvm::Module &M, llvm::ModuleAnalysisManager &AM,
                  const Options &Opts);

/// The contents of the file if the analysis failed because of \p Why. \p Known
/// holds the counts so far, or is null.
UnitInfo describeFailure(const Options &Opts, llvm::StringRef Why,
                         const llvm::json::Object *Known);

/// The fields that every file has, also if the analysis failed.
llvm::json::Object headerOf(const Options &Opts);

/// \p O as one of UnitInfo::Comparisons.
std::string writtenComparison(llvm::json::Object O);

/// Writes \p Unit to a temporary file beside \p Path and renames that.
llvm::Error writeJson(UnitInfo Unit, llvm::StringRef Path);

} // namespace tpc

#endif // TPC_STATICINFO_H
