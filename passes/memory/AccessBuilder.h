//===- AccessBuilder.h - Fills an AccessIndex -----------------------------===//
//
// Visits the module once and records loads, stores, copies and calls by the
// locations that their pointers lead to.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_ACCESSBUILDER_H
#define TPC_ACCESSBUILDER_H

#include "Rules.h"
#include "memory/AccessIndex.h"
#include "memory/PointsTo.h"

#include "llvm/ADT/DenseMap.h"
#include "llvm/ADT/SmallBitVector.h"

namespace tpc {

class AccessBuilder {
public:
  AccessBuilder(AccessIndex &R, PointsTo &Pointers,
                const CallGraphResult &Calls, const RuleMatches &Rules,
                llvm::Module &M)
      : R(R), Pointers(Pointers), Calls(Calls), Rules(Rules), M(M) {}

  /// Records all accesses.
  void fileAccesses();

private:
  void addWrite(llvm::Instruction &I, const Location &L);
  void addHanded(llvm::CallBase &Call, const Location &L);
  void addCopy(llvm::Instruction &I, Locations To, Locations From);
  void putInto(llvm::CallBase &Call);
  void fileReplacing(llvm::CallBase &Call, const llvm::Value *Pointer);
  void fileFurtherFields(llvm::MemTransferInst &Copy);
  void fileCall(llvm::CallBase &Call);
  bool isConstArgument(const llvm::CallBase &Call, unsigned N);

  AccessIndex &R;
  PointsTo &Pointers;
  const CallGraphResult &Calls;
  const RuleMatches &Rules;
  llvm::Module &M;
  /// Of functions without a body.
  llvm::DenseMap<const llvm::Function *, llvm::SmallBitVector> ConstArguments;
};

} // namespace tpc

#endif // TPC_ACCESSBUILDER_H
