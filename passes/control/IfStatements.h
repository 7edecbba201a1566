//===- IfStatements.h - Which predicates control a block ------------------===//
//
// Thesis A.7, with control dependence instead of counted visits, so that early
// returns, loops and breaks are correct. A `throw` in user code leads to the
// handler that catches it, in the same function or in a caller. Calls that may
// throw for other reasons add no dependence.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_IFSTATEMENTS_H
#define TPC_IFSTATEMENTS_H

#include "llvm/ADT/DenseMap.h"
#include "llvm/ADT/DenseSet.h"
#include "llvm/ADT/SmallVector.h"
#include "llvm/IR/Instructions.h"
#include "llvm/IR/PassManager.h"

namespace tpc {

/// True if \p I chooses between alternatives: a conditional branch, a switch or
/// a select (a conditional expression without side effects).
bool isPredicate(const llvm::Instruction &I);

/// The value that \p Predicate tests.
llvm::Value *conditionOf(const llvm::Instruction &Predicate);

/// The type of the handler that \p T, a branch behind a landing pad, checks
/// for; null if \p T is no such branch.
const llvm::Constant *handlerAskedFor(const llvm::Instruction &T);

/// The successor that the terminator of \p BB takes if \p BB is entered from
/// \p From and the tested value is constant on this edge. Clang ends the
/// conditions of loops and variables, and scopes with cleanups, in such a
/// block; nested scopes end in several of them. Null if both successors are
/// possible.
const llvm::BasicBlock *decidedWay(const llvm::BasicBlock *From,
                                   const llvm::BasicBlock *BB);

class IfStatementsResult {
public:
  /// The predicates, and the calls that may throw, that directly control the
  /// beginning of \p BB.
  llvm::ArrayRef<llvm::Instruction *>
  controllers(const llvm::BasicBlock *BB) const {
    return controllersOf(BB);
  }
  /// The same for \p I, which may follow a call that throws.
  llvm::ArrayRef<llvm::Instruction *>
  controllers(const llvm::Instruction &I) const {
    return controllersOf(partOf(I));
  }
  /// True if \p BB runs whenever its function is called, or is only reached by
  /// an exception that nobody throws explicitly: then the calls of the function
  /// control it. A loop at the top level of a function has both kinds of
  /// controllers.
  bool isControlledByEntry(const llvm::BasicBlock *BB) const {
    return ByEntry.contains(BB);
  }
  bool isControlledByEntry(const llvm::Instruction &I) const {
    return ByEntry.contains(partOf(I));
  }
  /// The predicates that choose the path from \p From to \p BB.
  llvm::SmallVector<llvm::Instruction *, 4>
  choosers(const llvm::BasicBlock *From, const llvm::BasicBlock *BB) const;
  /// All predicates, in the order of the module.
  llvm::ArrayRef<llvm::Instruction *> predicates() const { return Predicates; }

private:
  friend class IfStatements;
  friend class IfStatementsPrinter;
  const llvm::Value *partOf(const llvm::Instruction &I) const;
  llvm::ArrayRef<llvm::Instruction *>
  controllersOf(const llvm::Value *Part) const;

  /// Keyed by what a part of a block begins with: the block itself, or a call
  /// in it that may throw and that the part follows.
  llvm::DenseMap<const llvm::Value *, llvm::SmallVector<llvm::Instruction *, 2>>
      Controllers;
  llvm::DenseSet<const llvm::Value *> ByEntry;
  /// The calls inside of blocks that may throw.
  llvm::DenseMap<const llvm::BasicBlock *,
                 llvm::SmallVector<llvm::Instruction *, 1>>
      Parted;
  /// The invokes that continue or go to a handler.
  llvm::DenseSet<const llvm::Instruction *> Choosing;
  /// For edges that are also taken after an earlier decision: the deciding
  /// instructions.
  llvm::DenseMap<std::pair<const llvm::BasicBlock *, const llvm::BasicBlock *>,
                 llvm::SmallVector<llvm::Instruction *, 2>>
      Decided;
  /// Blocks that are only entered where their successor is known.
  llvm::DenseSet<const llvm::BasicBlock *> Bypassed;
  llvm::SmallVector<llvm::Instruction *, 0> Predicates;
};

class IfStatements : public llvm::AnalysisInfoMixin<IfStatements> {
public:
  using Result = IfStatementsResult;
  Result run(llvm::Module &M, llvm::ModuleAnalysisManager &);

private:
  friend llvm::AnalysisInfoMixin<IfStatements>;
  static llvm::AnalysisKey Key;
};

/// `print<tpc-if-statements>`
class IfStatementsPrinter : public llvm::PassInfoMixin<IfStatementsPrinter> {
public:
  explicit IfStatementsPrinter(llvm::raw_ostream &OS) : OS(OS) {}
  llvm::PreservedAnalyses run(llvm::Module &M, llvm::ModuleAnalysisManager &AM);
  static bool isRequired() { return true; }

private:
  llvm::raw_ostream &OS;
};

} // namespace tpc

#endif // TPC_IFSTATEMENTS_H
