//===- Overriding.h - Functions that other libraries call -----------------===//
//
// A planner, a controller or a layer of a map is a class that derives from one
// of another library, which calls it through that. What such a call returns,
// and what it writes into the objects that it is handed, leaves the link unit.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_OVERRIDING_H
#define TPC_OVERRIDING_H

#include "Options.h"
#include "Rules.h"
#include "calls/SimpleCallGraph.h"

#include "llvm/ADT/SetVector.h"

namespace tpc {

/// The functions in \p M that override a virtual function of a class that
/// another library defined, in the order of the vtables. A class is another
/// library's
/// - if its type information is in another link unit;
/// - if it comes from a header of another package, or from one that is not user
///   code;
/// - in a shared library, if no call in it enters the function through a class.
/// The rules name classes that do not count.
llvm::SmallSetVector<llvm::Function *, 8>
overridingFunctions(llvm::Module &M, const CallGraphResult &Calls,
                    const RuleMatches &Rules, const Options &Opts);

/// The arguments through which \p F can write objects of its caller, and the
/// place of its result if that is an object.
llvm::SmallVector<const llvm::Argument *, 4>
writtenArguments(const llvm::Function &F);

} // namespace tpc

#endif // TPC_OVERRIDING_H
