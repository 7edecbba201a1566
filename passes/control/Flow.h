//===- Flow.h - The flow graphs that control dependence is taken from -----===//
#ifndef TPC_FLOW_H
#define TPC_FLOW_H

#include "control/ControlDependence.h"
#include "control/Throws.h"

#include "llvm/ADT/DenseMap.h"
#include "llvm/ADT/DenseSet.h"
#include "llvm/ADT/MapVector.h"
#include "llvm/ADT/SmallVector.h"
#include "llvm/IR/Instructions.h"

#include <map>

namespace tpc {

class UserSources;

/// Blocks that are not passed through: they can be left inside.
using LeftInside = llvm::MapVector<const llvm::BasicBlock *,
                                   llvm::SmallVector<llvm::Instruction *, 1>>;

/// The flow graphs of a function, with the two nodes of Ferrante et al. behind
/// the blocks: the entry, from which the function is either entered or not, and
/// the end of not entering it.
///
/// Of the edges that exceptions take they have those of what the user throws: a
/// call that leads to a `throw` can go on, or to the handler, or out of the
/// function; a block with such calls inside is a node for each part. Edges that
/// end the program (`noexcept`) are none.
///
/// Checks of libraries (that a pointer is not null, that a function is there)
/// that end the program are left out as exceptions are: nobody who reads the
/// source sees them.
class Flow {
public:
  /// A node for a block as it is on a way that is decided before it is entered.
  struct Copy {
    const llvm::BasicBlock *BB, *Next;
    unsigned Node;
  };

  Flow(llvm::Function &F, UserSources &Sources, const ThrowsResult &Thrown);

  unsigned idOf(const llvm::BasicBlock *BB) const { return Id.lookup(BB); }

  /// The blocks, in order; the number of one is that of its node.
  llvm::SmallVector<llvm::BasicBlock *, 32> Blocks;
  FlowGraph Plain;
  /// Edges into blocks that are decided by the edge lead to copies of them; in
  /// Plain those alone that exceptions take.
  FlowGraph Threaded;
  llvm::SmallVector<Copy, 8> Copies;
  size_t NumThrown = 0; ///< The first so many are the ways of exceptions.
  /// Blocks that are also entered where their ways are open, or by exceptions.
  std::vector<bool> Entered;
  LeftInside Left;
  /// For each node of Plain what decides at its end; null where nothing does.
  std::vector<llvm::Instruction *> Decider;
  /// A part of a block, behind the call that it begins with.
  struct Part {
    unsigned Block, Node;
    const llvm::Instruction *Begin;
  };
  llvm::SmallVector<Part, 0> Parts;

private:
  unsigned endOf(llvm::BasicBlock &BB);
  void invoke(unsigned Node, llvm::InvokeInst &Invoke,
              const ThrowsResult &Thrown);
  unsigned copy(llvm::ArrayRef<const llvm::BasicBlock *> Path);
  void findEntered();

  llvm::DenseMap<const llvm::BasicBlock *, unsigned> Id;
  std::map<std::vector<unsigned>, unsigned> ByPath;
  /// Where calls lead that nobody takes to throw.
  llvm::DenseSet<const llvm::BasicBlock *> Implicit;
  /// Where those lead that are.
  llvm::DenseSet<const llvm::BasicBlock *> Explicit;
};

} // namespace tpc

#endif // TPC_FLOW_H
