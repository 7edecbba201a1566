//===- PointsToSolver.h - Finds what pointers lead to ---------------------===//
//
// The least fixed point of the inclusions, round by round; a pointer is looked
// at again where what it takes its targets from has grown. What pointers in
// memory lead to is kept by place, so that all loads of it share it.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_POINTSTOSOLVER_H
#define TPC_POINTSTOSOLVER_H

#include "Rules.h"
#include "calls/SimpleCallGraph.h"
#include "memory/LocationIndex.h"
#include "memory/PointsTo.h"

namespace tpc {

class PointsToSolver {
public:
  PointsToSolver(PointsTo &R, const Aliases &Alias,
                 const CallGraphResult &Calls, const RuleMatches &Rules,
                 llvm::Module &M)
      : R(R), Alias(Alias), Calls(Calls), Rules(Rules), M(M),
        PointerStoreIndex(Alias) {}

  /// Fills in what the pointers of the module lead to.
  void findTargets();

private:
  /// The pointers that a pointer takes its targets from.
  struct Node {
    const llvm::Value *V;
    llvm::SmallVector<const llvm::Value *, 2> Sources;
    const llvm::Value *Container = nullptr; ///< leads to its elements
    Locations Where = {};                   ///< of a load: what it reads
    unsigned Done = 0;                      ///< when it was looked at
  };
  /// A store of a pointer.
  struct PointerStore {
    const llvm::StoreInst *I;
    Locations Where = {};
    unsigned Done = 0;
  };
  /// The pointers that are kept at a place: what all loads of it find.
  struct Content {
    Location Where;
    /// Only what is stored through pointers without a known root: for places
    /// with one, which share it.
    bool Unrooted;
    Locations Found = {};
    unsigned Done = 0;
  };
  /// What a function returns: arguments, and other pointers.
  struct Returned {
    llvm::SmallVector<unsigned, 2> Arguments;
    llvm::SmallVector<const llvm::Value *, 2> Others;
  };

  void makeNodes();
  void makeNode(llvm::Instruction &I);
  const Returned &returnedBy(const llvm::Function &F);
  void addReturned(const llvm::CallBase &Call, Node &N);
  void findFilled();
  bool findsComplete(const Node &Load) const;
  bool findComplete();
  unsigned contentAt(const Location &L, bool Unrooted);
  void collect(unsigned Number, Locations &Out);
  bool isDue(const Node &N) const;
  bool update(Node &N);
  bool update(PointerStore &S, unsigned Number);
  bool propagate();
  bool hasGrown(const llvm::Value *Pointer, unsigned Since) const {
    return Grown.lookup(PointsTo::baseOf(Pointer)) > Since;
  }

  PointsTo &R;
  const Aliases &Alias;
  const CallGraphResult &Calls;
  const RuleMatches &Rules;
  llvm::Module &M;
  llvm::SmallVector<Node, 0> Nodes;
  llvm::SmallVector<PointerStore, 0> PointerStores;
  LocationIndex PointerStoreIndex;
  llvm::SmallVector<Content, 0> Contents;
  LocationMap<unsigned> ContentIndex[2]; ///< of all, and of Unrooted
  llvm::DenseMap<const llvm::Function *, Returned> Results;
  /// Objects that hold pointers to a container's elements: iterators that are
  /// returned in memory, with the container.
  llvm::DenseMap<const llvm::Value *, llvm::SmallVector<const llvm::Value *, 1>>
      Iterators;
  /// The time, and when the targets of a pointer or the pointers that are kept
  /// in a slot became more.
  unsigned Now = 1;
  bool Assumed = false; ///< the complete pointers were guessed
  /// Locals that somebody else, or a copy, may put pointers into.
  llvm::DenseSet<const llvm::Value *> Filled;
  llvm::DenseMap<const llvm::Value *, unsigned> Grown;
  llvm::DenseMap<LocationIndex::Slot, unsigned> SlotGrown;
};

} // namespace tpc

#endif // TPC_POINTSTOSOLVER_H
