//===- TypeNumbers.h - Which LLVM types are one class ---------------------===//
#ifndef TPC_TYPENUMBERS_H
#define TPC_TYPENUMBERS_H

#include "llvm/ADT/DenseMap.h"
#include "llvm/ADT/SmallVector.h"
#include "llvm/ADT/StringMap.h"
#include "llvm/IR/DerivedTypes.h"

namespace tpc {

/// Numbers the classes of a module. A class that two files define may occur as
/// `class.A` and `class.A.7`: both get the same number if they look alike.
class TypeNumbers {
public:
  unsigned numberOf(llvm::StructType *T);
  llvm::StructType *typeOf(unsigned Number) const { return Types[Number]; }
  /// True for a class of the standard library.
  bool isStandard(unsigned Number) const;

private:
  llvm::DenseMap<llvm::StructType *, unsigned> Numbers;
  llvm::StringMap<llvm::SmallVector<unsigned, 1>> ByName;
  llvm::SmallVector<llvm::StructType *, 0> Types;
};

} // namespace tpc

#endif // TPC_TYPENUMBERS_H
