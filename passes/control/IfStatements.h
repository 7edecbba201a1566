//===- IfStatements.h - Which predicates control a block ------------------===//
//
// Thesis A.7, by control dependence instead of counting visits: early returns,
// loops and breaks come out right. A `throw` of the user's leads to the handler
// that takes it, in its own function and in those that call it; where other
// calls may throw, that makes no dependence.
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

/// True where \p I decides between two ways: a conditional branch, a switch,
/// or a select (a conditional expression whose sides cost nothing).
bool isPredicate(const llvm::Instruction &I);

/// What \p Predicate decides by.
llvm::Value *conditionOf(const llvm::Instruction &Predicate);

/// The type of the handler that \p T, a branch behind a landing pad, asks for;
/// null where it is no such branch.
const llvm::Constant *handlerAskedFor(const llvm::Instruction &T);

/// Where \p BB is entered from \p From, where its terminator then goes for
/// sure, because it decides by a value that is constant on this edge: clang
/// ends the conditions of loops and variables, and scopes with something to
/// clean up, in such a block, and scopes in scopes in several, one after the
/// other. Null where both ways stay open.
const llvm::BasicBlock *decidedWay(const llvm::BasicBlock *From,
                                   const llvm::BasicBlock *BB);

class IfStatementsResult {
public:
  /// The predicates, and the calls that may throw, that the beginning of \p BB
  /// is directly controlled by.
  llvm::ArrayRef<llvm::Instruction *>
  controllers(const llvm::BasicBlock *BB) const {
    return controllersOf(BB);
  }
  /// The same for \p I, which may stand behind a call that throws.
  llvm::ArrayRef<llvm::Instruction *>
  controllers(const llvm::Instruction &I) const {
    return controllersOf(partOf(I));
  }
  /// True where \p BB is begun whenever its function is called, or is reached
  /// by an exception alone that nobody threw explicitly: then the calls of the
  /// function control it. A loop at the top level of a function has both kinds
  /// of controllers.
  bool isControlledByEntry(const llvm::BasicBlock *BB) const {
    return ByEntry.contains(BB);
  }
  bool isControlledByEntry(const llvm::Instruction &I) const {
    return ByEntry.contains(partOf(I));
  }
  /// The predicates that choose the way from \p From to \p BB.
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

  /// By what a part of a block begins with: the block itself, or a call in it
  /// that may throw, for what stands behind that.
  llvm::DenseMap<const llvm::Value *, llvm::SmallVector<llvm::Instruction *, 2>>
      Controllers;
  llvm::DenseSet<const llvm::Value *> ByEntry;
  /// The calls inside of blocks that may throw.
  llvm::DenseMap<const llvm::BasicBlock *,
                 llvm::SmallVector<llvm::Instruction *, 1>>
      Parted;
  /// The invokes that lead on or to a handler.
  llvm::DenseSet<const llvm::Instruction *> Choosing;
  /// Of edges that are also gone where that was decided before: by what.
  llvm::DenseMap<std::pair<const llvm::BasicBlock *, const llvm::BasicBlock *>,
                 llvm::SmallVector<llvm::Instruction *, 2>>
      Decided;
  /// Blocks that are entered only where it is decided how they go on.
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
