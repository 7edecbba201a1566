//===- HeldNumbers.h - Objects that hold one number -----------------------===//
//
// A ros::Time or ros::Duration is a number of seconds, kept as two integers and
// compared by operators of the library, which are not analysed. In the copy
// that is analysed, what these operators do is written as arithmetic with
// numbers (`held` in rules/*.json), so that everything known about numbers
// holds for times too.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_HELDNUMBERS_H
#define TPC_HELDNUMBERS_H

#include "llvm/IR/IRBuilder.h"

namespace tpc {

class RuleMatches;
struct Rule;

/// Writes the comparisons, arithmetic and assignments of held numbers in \p M,
/// a copy, as such. The outcome of a comparison is then that of an FCmpInst;
/// the calls stay.
void exposeHeldNumbers(llvm::Module &M, const RuleMatches &Rules);

/// The seconds in the object at \p Object, which \p Operator compares: a time
/// counts from 1970 without a sign, a duration has one. \p Row describes the
/// operator.
llvm::Value *heldSeconds(llvm::IRBuilder<> &B, llvm::Value *Object,
                         const llvm::CallBase &Operator, const Rule &Row);

} // namespace tpc

#endif // TPC_HELDNUMBERS_H
