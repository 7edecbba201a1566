//===- Overwrites.h - Values that another surely replaces -----------------===//
//
// `param("angle", angle_, 45.0); angle_ *= M_PI / 180;`: nobody but the second
// line ever sees the degrees. A field is followed to all its loads wherever
// they are; this takes out those that only a later write of the same function
// can reach.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_OVERWRITES_H
#define TPC_OVERWRITES_H

#include "IfStatements.h"
#include "SimpleCallGraph.h"

#include "llvm/IR/Dominators.h"

namespace tpc {

class Overwrites {
public:
  Overwrites(const IfStatementsResult &Ifs, const CallGraphResult &Calls)
      : Ifs(Ifs), Calls(Calls) {}

  /// Takes out of \p Loads, which read the variable at \p Pointer, those that
  /// what \p Write puts there does not reach, because a store that runs
  /// whenever Write has run comes in between.
  void remove(const llvm::Instruction &Write, const llvm::Value *Pointer,
              llvm::SmallVectorImpl<llvm::LoadInst *> &Loads);

private:
  const llvm::StoreInst *next(const llvm::Instruction &Write,
                              const llvm::Value *Pointer);
  bool runsBetween(const llvm::Function &F, const llvm::Instruction &Write,
                   const llvm::StoreInst &Next);
  const llvm::DominatorTree &dominators(const llvm::Function &F);

  const IfStatementsResult &Ifs;
  const CallGraphResult &Calls;
  llvm::DenseMap<const llvm::Function *, std::unique_ptr<llvm::DominatorTree>>
      Trees;
};

} // namespace tpc

#endif // TPC_OVERWRITES_H
