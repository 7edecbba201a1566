//===- Overriding.h - Functions that other libraries call -----------------===//
//
// A planner, a controller or a layer of a map is a class that derives from one
// of another library, which calls it through that. What such a call returns,
// and what it writes into the objects that it is handed, leaves the link unit.
// So does what its class writes into the part of its object that it inherits
// from there.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_OVERRIDING_H
#define TPC_OVERRIDING_H

#include "Options.h"
#include "Rules.h"
#include "calls/SimpleCallGraph.h"

#include "llvm/ADT/SetVector.h"
#include "llvm/ADT/StringSet.h"

namespace tpc {

struct OverridingFunctions {
  llvm::SmallSetVector<llvm::Function *, 8> Functions;
  /// The classes whose functions they override, by their qualified names.
  llvm::StringSet<> Bases;
};

/// The functions in \p M that override a virtual function of a class that
/// another library defined, in the order of the vtables. A class is another
/// library's
/// - if its type information is in another link unit;
/// - if it comes from a header of another package, or from one that is not user
///   code;
/// - in a shared library, if no call in it enters the function through a class.
/// The rules name classes that do not count.
OverridingFunctions overridingFunctions(llvm::Module &M,
                                        const CallGraphResult &Calls,
                                        const RuleMatches &Rules,
                                        const Options &Opts);

/// The arguments through which \p F can write objects of its caller, and the
/// place of its result if that is an object.
llvm::SmallVector<const llvm::Argument *, 4>
writtenArguments(const llvm::Function &F);

/// A store, or a call of a method of another library, through which a method
/// changes the inherited part of its object.
struct InheritedWrite {
  llvm::Instruction *I;
  std::string Class; ///< that the part is of, without scopes
};

/// Those in the methods of the classes with \p Overriding functions, in the
/// order of the module.
llvm::SmallVector<InheritedWrite, 0>
inheritedWrites(llvm::Module &M, const OverridingFunctions &Overriding);

} // namespace tpc

#endif // TPC_OVERRIDING_H
