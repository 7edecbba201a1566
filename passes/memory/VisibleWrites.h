//===- VisibleWrites.h - Which writes a read sees -------------------------===//
//
// Of the accesses that may touch the same memory (see AccessIndex.h), keeps
// those that the order of the code allows: for a local variable by
// LocalWrites.h, for shared memory by Reaching.h. A write is left out if other
// writes replace its value on every path to the read.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_VISIBLEWRITES_H
#define TPC_VISIBLEWRITES_H

#include "memory/LocalWrites.h"
#include "memory/Reaching.h"
#include "memory/Received.h"

namespace tpc {

class VisibleWrites {
public:
  VisibleWrites(llvm::Module &M, llvm::ModuleAnalysisManager &AM);

  /// The writes that can give \p Load its value: stores, memset, and calls
  /// without a body that get a pointer to the variable. Copies of whole objects
  /// are followed.
  llvm::ArrayRef<llvm::Instruction *> definitionsOf(const llvm::LoadInst &Load);

  /// The loads that can read the value that \p Write, a store or call, writes
  /// to the scalar at \p Pointer.
  llvm::SmallVector<llvm::LoadInst *, 8> usesOf(const llvm::Instruction &Write,
                                                const llvm::Value *Pointer);

  /// The loads that can read a number that \p Write, a call, puts into the list
  /// with the elements \p Elements, or into a list that is one of them. If
  /// \p Write is null, whatever wrote it.
  llvm::SmallVector<llvm::LoadInst *, 8>
  elementsFrom(const llvm::Instruction *Write, const Locations &Elements);

  /// The writes of the scalar at \p L that \p At, which reads it at \p Pointer,
  /// can see.
  llvm::SmallVector<llvm::Instruction *, 8>
  writesOf(const Location &L, const llvm::Instruction &At,
           const llvm::Value *Pointer);
  /// The writes into the object at \p L that \p At, which gets a pointer
  /// \p Pointer to it, can see.
  llvm::SmallVector<llvm::Instruction *, 8>
  writesInto(const Location &L, const llvm::Instruction &At,
             const llvm::Value *Pointer);

  /// True if \p At, which reads \p L at \p Pointer, sees the same writes as all
  /// other reads of it: it is not a local variable of \p At's function, and no
  /// write of it is replaced before others can see it.
  bool isSharedBy(const Location &L, const llvm::Instruction &At,
                  const llvm::Value *Pointer);

  /// True if another process filled what \p Pointer leads to.
  bool isReceived(const llvm::Value *Pointer) const {
    return Messages.has(Pointer);
  }
  /// True if another process may have filled it, for all that is known.
  bool mayBeReceived(const llvm::Value *Pointer) const {
    return Messages.mayHave(Pointer);
  }

  /// True if \p Call always gives the object at \p Pointer a new value.
  bool replaces(const llvm::CallBase &Call, const llvm::Value *Pointer) const;

  /// How often the search for the readers of a write was skipped because the
  /// link unit is too large. In that case all reads see it.
  unsigned givenUp() const { return Locals.givenUp() + Shared.givenUp(); }

private:
  using Writes = AccessIndex::Writes;
  /// The writes of a variable that is not local.
  struct SharedWrites {
    llvm::SmallVector<llvm::Instruction *, 8> Own; ///< of the variable itself
    /// Through copies of whole objects.
    llvm::SmallVector<llvm::Instruction *, 8> Copied;
    bool TooMany = false;  ///< Own has those of Copied, too
    bool Narrowed = false; ///< some read of it does not see all of Own
  };
  /// A part of an object, and how a function names it.
  struct Part {
    llvm::SmallVector<Step, 4> Way;
    Reaching::Variable Variable;
  };

  Writes allWrites(const Location &L);
  const SharedWrites &sharedWrites(const Location &L);
  const llvm::Value *placeOf(const llvm::Instruction &I);
  std::optional<Reaching::Variable> variableAt(const llvm::Value *Pointer,
                                               const Location &L) const;
  std::optional<Reaching::Variable> writtenBy(const llvm::Instruction &Write,
                                              const Location &L) const;
  llvm::SmallVector<Part, 4> replacedParts(const Location &L,
                                           const llvm::Instruction &At,
                                           const llvm::Value *Pointer);

  const llvm::DataLayout &Layout;
  const LocationTypes &Types;
  const Aliases &Alias;
  PointsTo &Pointers;
  AccessIndex &Accesses;
  LocalWrites Locals;
  Reaching Shared;
  Received Messages;
  /// Cached results.
  llvm::DenseMap<const llvm::LoadInst *,
                 std::unique_ptr<llvm::SmallVector<llvm::Instruction *, 8>>>
      Definitions;
  llvm::DenseMap<const llvm::Instruction *, const llvm::Value *> Places;
  LocationMap<SharedWrites> ByVariable;
};

class VisibleWritesAnalysis
    : public llvm::AnalysisInfoMixin<VisibleWritesAnalysis> {
public:
  using Result = VisibleWrites;
  Result run(llvm::Module &M, llvm::ModuleAnalysisManager &AM) {
    return VisibleWrites(M, AM);
  }

private:
  friend llvm::AnalysisInfoMixin<VisibleWritesAnalysis>;
  static llvm::AnalysisKey Key;
};

/// `print<tpc-visible-writes>`
class VisibleWritesPrinter : public llvm::PassInfoMixin<VisibleWritesPrinter> {
public:
  explicit VisibleWritesPrinter(llvm::raw_ostream &OS) : OS(OS) {}
  llvm::PreservedAnalyses run(llvm::Module &M, llvm::ModuleAnalysisManager &AM);
  static bool isRequired() { return true; }

private:
  llvm::raw_ostream &OS;
};

} // namespace tpc

#endif // TPC_VISIBLEWRITES_H
