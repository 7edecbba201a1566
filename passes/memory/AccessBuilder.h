//===- AccessBuilder.h - Fills an AccessResult ----------------------------===//
//
// In two steps: PointsTo.cpp finds what pointers lead to, AccessBuilder.cpp
// files the loads, stores, copies and calls by it.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_ACCESSBUILDER_H
#define TPC_ACCESSBUILDER_H

#include "Rules.h"
#include "memory/ClassObjectAccess.h"

#include "llvm/ADT/Hashing.h"

namespace tpc {

struct AccessResult::Builder {
  Builder(AccessResult &R, const CallGraphResult &Calls,
          const RuleMatches &Rules, llvm::Module &M)
      : R(R), Calls(Calls), Rules(Rules), M(M) {}

  /// Finds what the pointers of the module lead to.
  void findTargets();
  /// Files what reads and writes; after findTargets.
  void fileKept(const llvm::StoreInst &Store);
  void fileAccesses();

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

  void findEscaped();
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
  void addElements(const llvm::Value *Container, Locations &Out) const;
  bool hasGrown(const llvm::Value *Pointer, unsigned Since) const {
    return Grown.lookup(baseOf(Pointer)) > Since;
  }

  void addWrite(llvm::Instruction &I, const Location &L);
  void addCopy(llvm::Instruction &I, Locations To, Locations From);
  void putInto(llvm::CallBase &Call);
  void fileReplacing(llvm::CallBase &Call, const llvm::Value *Pointer);
  void fileCall(llvm::CallBase &Call);

  AccessResult &R;
  const CallGraphResult &Calls;
  const RuleMatches &Rules;
  llvm::Module &M;
  llvm::SmallVector<Node, 0> Nodes;
  llvm::SmallVector<PointerStore, 0> PointerStores;
  Index PointerStoreIndex;
  llvm::SmallVector<Content, 0> Contents;
  llvm::DenseMap<llvm::hash_code, llvm::SmallVector<unsigned, 1>> ContentIndex;
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
  llvm::DenseMap<Slot, unsigned> SlotGrown;
};

/// The container that \p Call is a method of.
const llvm::Value *containerOf(const llvm::CallBase &Call);

} // namespace tpc

#endif // TPC_ACCESSBUILDER_H
