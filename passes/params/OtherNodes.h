//===- OtherNodes.h - Parameters of other nodes ---------------------------===//
//
// A program can ask for the parameters of another node by that node's name
// (`node` in rules/*.json). They are none of the program's own.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_OTHERNODES_H
#define TPC_OTHERNODES_H

#include "Rules.h"

#include "llvm/ADT/StringSet.h"

namespace tpc {

class Texts;

class OtherNodes {
public:
  OtherNodes(llvm::Module &M, llvm::ModuleAnalysisManager &AM, Texts &Known)
      : M(M), Tables(*AM.getResult<RuleTableAnalysis>(M).Tables), Known(Known) {
  }

  /// True if \p Call, described by \p Row, asks for a parameter of another
  /// node: the name of the node is constant, and no node here is made with it.
  bool have(const llvm::CallBase &Call, const Rule &Row);

private:
  const llvm::StringSet<> &ownNames();

  llvm::Module &M;
  const Rules &Tables;
  Texts &Known;
  /// The names that nodes are made with, without namespaces; collected once, if
  /// needed.
  std::optional<llvm::StringSet<>> Own;
};

} // namespace tpc

#endif // TPC_OTHERNODES_H
