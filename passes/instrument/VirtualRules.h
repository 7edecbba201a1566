//===- VirtualRules.h - Virtual functions that rules describe -------------===//
//
// A row of the rules names a function. If the function is virtual, a call
// through a pointer does not name it: what it may enter depends on the object.
// In the copy that is analysed, such a call is made a direct call of the
// function that the class of the pointer declares.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_VIRTUALRULES_H
#define TPC_VIRTUALRULES_H

#include "llvm/IR/Module.h"

namespace tpc {

class Rules;

/// Makes the virtual calls in \p M, a copy, direct calls if a row of \p Tables
/// describes the function that the class of their object declares: a call
/// through a class whose own override no row describes stays as it is, and so
/// does one whose class is not known.
void nameVirtualCalls(llvm::Module &M, const Rules &Tables);

} // namespace tpc

#endif // TPC_VIRTUALRULES_H
