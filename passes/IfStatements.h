//===- IfStatements.h - Which predicates control a block ------------------===//
//
// Thesis A.7, by control dependence instead of counting visits: early returns,
// loops and breaks come out right. Exception edges make no dependence.
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

/// Where \p BB is entered from \p From, where its terminator then goes for
/// sure, because it decides by a value that is constant on this edge: clang
/// ends the conditions of loops and variables, and scopes with something to
/// clean up, in such a block, and scopes in scopes in several, one after the
/// other. Null where both ways stay open.
const llvm::BasicBlock *decidedWay(const llvm::BasicBlock *From,
                                   const llvm::BasicBlock *BB);

class IfStatementsResult {
public:
  /// The terminators that \p BB is directly controlled by.
  llvm::ArrayRef<llvm::Instruction *>
  controllers(const llvm::BasicBlock *BB) const;
  /// True where \p BB runs whenever its function is called, or is reached
  /// by an exception alone: then the calls of the function control it. A loop
  /// at the top level of a function has both kinds of controllers.
  bool isControlledByEntry(const llvm::BasicBlock *BB) const {
    return ByEntry.contains(BB);
  }
  /// The predicates that choose the way from \p From to \p BB.
  llvm::SmallVector<llvm::Instruction *, 4>
  choosers(const llvm::BasicBlock *From, const llvm::BasicBlock *BB) const;
  /// All predicates, in the order of the module.
  llvm::ArrayRef<llvm::Instruction *> predicates() const { return Predicates; }

private:
  friend class IfStatements;
  llvm::DenseMap<const llvm::BasicBlock *,
                 llvm::SmallVector<llvm::Instruction *, 2>>
      Controllers;
  llvm::DenseSet<const llvm::BasicBlock *> ByEntry;
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
