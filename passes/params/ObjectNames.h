//===- ObjectNames.h - Names of parameters that objects hold --------------===//
//
// The name of the parameter that an object holds, where the program gets the
// object from elsewhere: the name that it is compared with on the way, or for
// which the function that gets the object is called back.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_OBJECTNAMES_H
#define TPC_OBJECTNAMES_H

#include "Options.h"
#include "Rules.h"
#include "calls/SimpleCallGraph.h"

#include "llvm/IR/Dominators.h"

#include <map>
#include <set>

namespace tpc {

class Texts;

class ObjectNames {
public:
  ObjectNames(llvm::Module &M, llvm::ModuleAnalysisManager &AM, Texts &Known);

  /// The names with which the name of \p Object was compared on every way to
  /// \p At.
  std::set<std::string> testedOn(const llvm::CallBase &At,
                                 const llvm::Value *Object);

  /// The names of the objects that the program's own functions hand to
  /// \p Given, and of those that its function is called back with. None if they
  /// are parameters of other nodes.
  std::set<std::string> givenTo(const llvm::Argument &Given);

private:
  void addTest(const llvm::CallBase &Test, const Rule &Row,
               const llvm::Value *Name, const llvm::CallBase &At,
               std::set<std::string> &Out);

  const RuleMatches &Rules;
  const CallGraphResult &Calls;
  Texts &Known;
  UserSources Sources;
  /// Calls that return the name of an object.
  llvm::SmallVector<llvm::CallBase *, 0> Identities;
  /// The parameter of this node whose objects a function is called back with;
  /// empty if all are parameters of other nodes.
  llvm::DenseMap<const llvm::Function *, std::string> CalledFor;
  std::map<const llvm::Function *, llvm::DominatorTree> Trees;
};

} // namespace tpc

#endif // TPC_OBJECTNAMES_H
