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
    unsigned Done = 0;                      ///< when it was last updated
  };
  /// A store of a pointer.
  struct PointerStore {
    const llvm::StoreInst *I;
    Locations Where = {};  ///< the places that it stores to
    Locations Stored = {}; ///< what the pointer leads to
    unsigned Done = 0;
    unsigned Grown = 0; ///< when either of them last gained something
  };
  /// The pointers stored at a place, which all loads of it find.
  struct Content {
    Location Where;
    /// Only what is stored through pointers without a known root. Places with a
    /// root share it.
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
  void noteMove(const llvm::CallBase &Call);
  const Returned &returnedBy(const llvm::Function &F);
  void addReturned(const llvm::CallBase &Call, Node &N);
  void addExtracted(const llvm::ExtractValueInst &Extract, Node &N);
  void findFilled();
  bool findsComplete(const Node &Load) const;
  bool hasOwnCallers(const llvm::Argument &Arg);
  bool keepsElements(const Node &N) const;
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
  /// Of all stores, and of Unrooted ones.
  LocationMap<unsigned> ContentIndex[2];
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
  /// Locals into which other code, or a copy, may put pointers.
  llvm::DenseSet<const llvm::Value *> Filled;
  llvm::DenseMap<const llvm::Value *, unsigned> Grown;
  llvm::DenseMap<LocationIndex::Slot, unsigned> SlotGrown;
};

} // namespace tpc

#endif // TPC_POINTSTOSOLVER_H
