//===- KeptObjects.h - Objects handed over in an earlier call -------------===//
//
// A planner or a recovery behaviour gets the robot's maps once, when it is
// initialised, and changes them in later calls. Like what a function writes
// into the objects that it is handed itself, this leaves the link unit.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_KEPTOBJECTS_H
#define TPC_KEPTOBJECTS_H

#include "slice/Overriding.h"
#include "support/DebugTypes.h"

namespace tpc {

/// What the classes with \p Overriding functions write, in any of their
/// methods, into the objects to which these functions were handed pointers and
/// which a member of the class points to since then: stores, and calls of
/// methods without a body that are not const. A method that returns a pointer
/// gives access to a part of the object and writes nothing by itself. The class
/// of a write is that of the object, or of the part that is written. In the
/// order of the module.
llvm::SmallVector<InheritedWrite, 0>
keptObjectWrites(llvm::Module &M, const CallGraphResult &Calls,
                 const RuleMatches &Rules, DebugTypes &Debug,
                 const OverridingFunctions &Overriding, UserSources Sources);

} // namespace tpc

#endif // TPC_KEPTOBJECTS_H
