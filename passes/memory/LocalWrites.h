//===- LocalWrites.h - Which writes of a local variable a read sees -------===//
//
// Reaching definitions (Aho, Sethi and Ullman, "Compilers", 10.5) of one local
// variable at one place, by walking the flow graph of its function back from
// there to the writes that surely replace the value. A write in another
// function happens at a call that is handed the variable; where its address was
// stored away, all of them stay, and only those that name the variable are
// followed.
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

  /// Leaves in \p W, the writes of the local variable \p L of \p At's function,
  /// those that reach \p At.
  void keepReaching(const llvm::Instruction &At, const Location &L,
                    AccessIndex::Writes &W);

  /// How often it was not looked, for the unit is too large.
  unsigned givenUp() const { return GivenUp; }

private:
  /// What happens to a local variable in its function: the writes of it, and
  /// the calls that are handed it, by block and in order.
  struct History {
    bool Known = false; ///< else others may do anything to it anywhere
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
