//===- StaticInfo.h - The static information of a link unit ---------------===//
//
// docs/reference/formats.md: one JSON file per link unit.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_STATICINFO_H
#define TPC_STATICINFO_H

#include "Options.h"
#include "results/GatherResults.h"

#include "llvm/Support/Error.h"
#include "llvm/Support/JSON.h"

namespace tpc {

/// What a unit's file says. The comparisons are text already: there are many.
struct UnitInfo {
  llvm::json::Object Fields;
  std::vector<std::string> Comparisons;
};

/// What a unit's file says of the analysis of \p M.
UnitInfo describe(llvm::Module &M, llvm::ModuleAnalysisManager &AM,
                  const Options &Opts);

/// What a unit's file says where the analysis failed because of \p Why;
/// \p Known has the counts as far as it came, or is null.
UnitInfo describeFailure(const Options &Opts, llvm::StringRef Why,
                         const llvm::json::Object *Known);

/// Writes \p Unit to \p Path, beside and then renamed.
llvm::Error writeJson(UnitInfo Unit, llvm::StringRef Path);

} // namespace tpc

#endif // TPC_STATICINFO_H
