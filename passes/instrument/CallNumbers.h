//===- CallNumbers.h - Calls that can be found again ----------------------===//
//
// A call of a program is a different value in a copy of the program, and may be
// several ones after inlining. All of them keep its number.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_CALLNUMBERS_H
#define TPC_CALLNUMBERS_H

#include "llvm/IR/InstrTypes.h"
#include "llvm/IR/Module.h"

namespace tpc {

class CallNumbers {
public:
  /// Gives each call of a function in \p M a number.
  void number(llvm::Module &M);
  /// \p There and \p Here are copies of the same function, of the program and
  /// of the prepared program: gives the calls of \p There new numbers, and
  /// those calls in \p Here that stem from them.
  void renew(llvm::Function &There, llvm::Function &Here);
  /// 0 if it has none.
  static unsigned of(const llvm::CallBase &Call);

private:
  unsigned Last = 0;
};

} // namespace tpc

#endif // TPC_CALLNUMBERS_H
