//===- Aliases.h - Which locations can be the same memory -----------------===//
//
// The paths of two locations decide whether they can be the same: a location
// without a root is the end of a longer path. In addition, a local variable
// whose address does not escape cannot be reached by a pointer of another
// function.
//
// Every question whether two locations can meet is answered here; the index in
// LocationIndex.h uses the same rules.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_ALIASES_H
#define TPC_ALIASES_H

#include "calls/SimpleCallGraph.h"
#include "memory/CalledBack.h"
#include "memory/LocationTypes.h"

#include "llvm/ADT/DenseSet.h"

#include <optional>

namespace tpc {

class Aliases {
public:
  Aliases(llvm::Module &M, const CallGraphResult &Calls, CalledBack &Back,
          LocationTypes &Types);

  /// True if a pointer without a known root can lead to \p L.
  bool isReachable(const Location &L) const;
  /// Location::mayBe, and what is known about local variables.
  bool mayBe(const Location &A, const Location &B) const;
  /// The path from \p Object to \p L, if \p L can be \p Object or a part of it.
  std::optional<llvm::SmallVector<Step, 4>> partOf(const Location &Object,
                                                   const Location &L) const;

private:
  void findEscaped(llvm::Module &M, const CallGraphResult &Calls,
                   CalledBack &Back);

  LocationTypes &Types;
  /// The locals that are found by their class, because code elsewhere can reach
  /// them without naming them.
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
