//===- Aliases.h - Which locations can be the same memory -----------------===//
//
// Two locations can be the same where their paths say so: one without a root is
// the end of a longer path. Besides, a local variable whose address stays with
// its own function is nothing that a pointer of another function leads to.
//
// All that asks whether two locations meet asks here, and what is filed by
// location in LocationIndex.h is found by the same rules.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_ALIASES_H
#define TPC_ALIASES_H

#include "calls/SimpleCallGraph.h"
#include "memory/LocationTypes.h"

#include "llvm/ADT/DenseSet.h"

#include <optional>

namespace tpc {

class Aliases {
public:
  Aliases(llvm::Module &M, const CallGraphResult &Calls, LocationTypes &Types);

  /// True where a pointer without a known root can lead to \p L.
  bool isReachable(const Location &L) const;
  /// Location::mayBe, with what is known of local variables.
  bool mayBe(const Location &A, const Location &B) const;
  /// The way from \p Object to \p L, where \p L can be \p Object or in it.
  std::optional<llvm::SmallVector<Step, 4>> partOf(const Location &Object,
                                                   const Location &L) const;

private:
  void findEscaped(llvm::Module &M, const CallGraphResult &Calls);

  LocationTypes &Types;
  /// The locals that code elsewhere can reach without naming them.
  llvm::DenseSet<const llvm::Value *> Escaped;
};

class AliasesAnalysis : public llvm::AnalysisInfoMixin<AliasesAnalysis> {
public:
  using Result = Aliases;
  Result run(llvm::Module &M, llvm::ModuleAnalysisManager &AM);

private:
  friend llvm::AnalysisInfoMixin<AliasesAnalysis>;
  static llvm::AnalysisKey Key;
};

} // namespace tpc

#endif // TPC_ALIASES_H
