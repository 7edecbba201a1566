//===- LocalWrites.h - Which writes of a local variable a read sees -------===//
//
// Reaching definitions (Aho, Sethi and Ullman, "Compilers", 10.5) of one local
// variable at one instruction: walks the control flow back from the instruction
// to the writes that always replace the value. A write in another function
// happens at a call that gets a pointer to the variable. If the address was
// stored, all of those writes stay, and only the writes that name the variable
// are followed.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_LOCALWRITES_H
#define TPC_LOCALWRITES_H

#include "Rules.h"
#include "memory/AccessIndex.h"
#include "memory/PointsTo.h"

#include "llvm/ADT/MapVector.h"
#include "llvm/ADT/SmallPtrSet.h"

#include <memory>
#include <optional>

namespace tpc {

class LocalWrites {
public:
  LocalWrites(llvm::Module &M, const RuleMatches &Rules,
              const LocationTypes &Types, PointsTo &Pointers,
              const AccessIndex &Accesses);

  /// Keeps in \p W, the writes of the local variable \p L of \p At's function,
  /// only those that reach \p At.
  void keepReaching(const llvm::Instruction &At, const Location &L,
                    AccessIndex::Writes &W);

  /// How often the search was skipped because the link unit is too large.
  unsigned givenUp() const { return GivenUp; }

private:
  /// What happens to a local variable in its function, by block and in order:
  /// the writes of it, and the calls that get a pointer to it.
  struct History {
    bool Known = false; ///< if false, other code may change it at any time
    llvm::SmallPtrSet<const llvm::Instruction *, 8> Writes;
    llvm::MapVector<const llvm::BasicBlock *,
                    llvm::SmallVector<const llvm::Instruction *, 2>>
        Events;
  };

  void findKept(llvm::Module &M, const RuleMatches &Rules);
  std::optional<llvm::SmallVector<llvm::Instruction *, 4>>
  handedTo(const llvm::AllocaInst &Local);
  const History &historyOf(const Location &L,
                           llvm::ArrayRef<llvm::Instruction *> W);
  bool isOneScalar(const Location &L, const llvm::StoreInst &Store);
  bool replaces(const llvm::Instruction &Write, const Location &L);

  const LocationTypes &Types;
  PointsTo &Pointers;
  const AccessIndex &Accesses;
  /// The locals whose address another function has stored somewhere.
  llvm::DenseSet<const llvm::Value *> KeptElsewhere;
  llvm::DenseMap<
      const llvm::Value *,
      llvm::SmallVector<std::pair<Location, std::unique_ptr<const History>>, 1>>
      Histories;
  unsigned Walked = 0, GivenUp = 0;
};

} // namespace tpc

#endif // TPC_LOCALWRITES_H
