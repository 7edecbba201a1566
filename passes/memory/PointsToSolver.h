//===- PointsToSolver.h - Computes what pointers lead to ------------------===//
//
// Computes the least fixed point of the inclusions in rounds. A pointer is
// updated when one of its sources has gained targets. The pointers in memory
// are kept by place, so that all loads of a place share them.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_POINTSTOSOLVER_H
#define TPC_POINTSTOSOLVER_H

#include "Rules.h"
#include "calls/SimpleCallGraph.h"
#include "memory/LocationIndex.h"
#include "memory/PointsTo.h"

#include "llvm/ADT/StringSet.h"

#include <vector>

namespace tpc {

class PointsToSolver {
public:
  PointsToSolver(PointsTo &R, const Aliases &Alias,
                 const CallGraphResult &Calls, const RuleMatches &Rules,
                 llvm::Module &M)
      : R(R), Alias(Alias), Calls(Calls), Rules(Rules), M(M),
        PointerStoreIndex(Alias) {}

  /// Computes what the pointers of the module lead to.
  void findTargets();

private:
  /// The pointers whose targets a pointer takes over.
  struct Node {
    const llvm::Value *V;
    llvm::SmallVector<const llvm::Value *, 2> Sources;
    const llvm::Value *Container = nullptr; ///< if set, leads to its elements
    Locations Where = {};                   ///< of a load: what it reads
    llvm::SmallVector<unsigned, 1> Slots = {}; ///< those of Where
    unsigned Done = 0;                         ///< when it was last updated
    bool IsComplete = false;                   ///< it is in PointsTo::Complete
    /// The node that each source is computed from.
    llvm::SmallVector<unsigned, 2> Bases = {};
    /// The same for the container, or for what a load reads through.
    unsigned Base = NoNode;
    /// What must be complete for this to be: of the sources and the container.
    llvm::SmallVector<unsigned, 2> Needs = {};
    unsigned ReadNeeds = AllKnown; ///< of a load: what it reads through
  };
  /// Instead of the number of a node: a pointer that is not computed from one,
  /// and such a pointer of which all objects are known.
  static constexpr unsigned NoNode = ~0U, AllKnown = ~0U - 1;
  /// A store of a pointer.
  struct PointerStore {
    const llvm::StoreInst *I;
    Locations Where = {};                      ///< the places that it stores to
    Locations Stored = {};                     ///< what the pointer leads to
    llvm::SmallVector<unsigned, 1> Slots = {}; ///< those of Where
    /// The nodes that the place and the pointer are computed from.
    unsigned To = NoNode, From = NoNode;
    unsigned Needs = NoNode; ///< of the pointer, see Node
    unsigned Done = 0;
    unsigned Grown = 0; ///< when either of them last gained something
  };
  /// The pointers stored at a place, which all loads of it find.
  struct Content {
    Location Where;
    /// Only what is stored through pointers without a known root. Places with a
    /// root share it.
    bool Unrooted;
    unsigned Slot;
    Locations Found = {};
    unsigned Done = 0;
  };
  /// The pointers that are stored where a load reads.
  struct StoredAt {
    llvm::SmallVector<unsigned, 2> Needs = {}; ///< of each, see Node
    bool IsComplete = false; ///< all of them were, when last asked
  };
  /// A pointer through which a local may be filled.
  struct Filling {
    const llvm::Value *Pointer;
    unsigned Base;     ///< the node that it is computed from
    unsigned Done = 0; ///< when it was last looked at
  };
  /// What a function returns: arguments, and other pointers.
  struct Returned {
    llvm::SmallVector<unsigned, 2> Arguments;
    llvm::SmallVector<const llvm::Value *, 2> Others;
  };

  void makeNodes();
  void makeNode(llvm::Instruction &I);
  void noteMove(const llvm::CallBase &Call);
  const Returned &returnedBy(const llvm::Function &F);
  void addReturned(const llvm::CallBase &Call, Node &N);
  void addExtracted(const llvm::ExtractValueInst &Extract, Node &N);
  void linkNodes();
  void noteFilling();
  unsigned baseOf(const llvm::Value *Pointer) const {
    return numberOf(PointsTo::baseOf(Pointer));
  }
  unsigned numberOf(const llvm::Value *V) const {
    auto It = Numbers.find(V);
    return It == Numbers.end() ? NoNode : It->second;
  }
  unsigned neededBy(const llvm::Value *V) const;
  bool isComplete(unsigned Needed) const {
    return Needed == AllKnown || (Needed != NoNode && Nodes[Needed].IsComplete);
  }
  bool areComplete(llvm::ArrayRef<unsigned> Needed) const {
    return llvm::all_of(Needed, [&](unsigned N) { return isComplete(N); });
  }
  void findFilled();
  StoredAt &storedAt(const Location &L);
  bool findsComplete(const Node &Load);
  bool hasOwnCallers(const llvm::Argument &Arg);
  bool keepsElements(const Node &N) const;
  bool findComplete();
  unsigned contentAt(const Location &L, bool Unrooted);
  void collect(unsigned Number, Locations &Out);
  bool isDue(const Node &N) const;
  bool update(Node &N);
  bool update(PointerStore &S, unsigned Number);
  bool propagate();
  bool hasGrown(unsigned Base, unsigned Since) const {
    return Base != NoNode && Grown[Base] > Since;
  }
  unsigned slotOf(const Location &L);

  PointsTo &R;
  const Aliases &Alias;
  const CallGraphResult &Calls;
  const RuleMatches &Rules;
  llvm::Module &M;
  llvm::SmallVector<Node, 0> Nodes;
  llvm::DenseMap<const llvm::Value *, unsigned> Numbers; ///< of the nodes
  llvm::SmallVector<PointerStore, 0> PointerStores;
  LocationIndex PointerStoreIndex;
  llvm::SmallVector<Content, 0> Contents;
  /// Of all stores, and of Unrooted ones.
  LocationMap<unsigned> ContentIndex[2];
  llvm::SmallVector<StoredAt, 0> Stored;
  LocationMap<unsigned> StoredIndex;
  llvm::DenseMap<const llvm::Function *, Returned> Results;
  /// Objects that hold pointers to a container's elements (iterators that are
  /// returned in memory), with the container.
  llvm::DenseMap<const llvm::Value *, llvm::SmallVector<const llvm::Value *, 1>>
      Iterators;
  /// The current time, and the times when a pointer gained targets or a slot
  /// gained pointers.
  unsigned Now = 1;
  bool Assumed = false; ///< the complete pointers are an assumption
  /// Container classes of which elements move from one object to another.
  llvm::StringSet<> Moved;
  llvm::SmallVector<Filling, 0> Fillings;
  /// Locals into which other code, or a copy, may put pointers.
  llvm::DenseSet<const llvm::Value *> Filled;
  std::vector<unsigned> Grown; ///< by the number of the node
  llvm::DenseMap<LocationIndex::Slot, unsigned> SlotNumbers;
  std::vector<unsigned> SlotGrown; ///< by the number of the slot
};

} // namespace tpc

#endif // TPC_POINTSTOSOLVER_H
