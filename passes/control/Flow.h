//===- Flow.h - The flow graphs that define control dependence ------------===//
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

/// Blocks that control may leave in the middle.
using LeftInside = llvm::MapVector<const llvm::BasicBlock *,
                                   llvm::SmallVector<llvm::Instruction *, 1>>;

/// The flow graphs of a function. Two nodes of Ferrante et al. follow the
/// blocks: the entry, which either enters the function or not, and the end of
/// not entering it.
///
/// Exceptions add edges only where user code throws. A call that leads to a
/// `throw` can continue, go to the handler or leave the function; a block with
/// such calls inside has one node for each part. Edges that end the program
/// (`noexcept`) are left out.
///
/// Edges that are never taken, according to the compiler, are left out.
///
/// Checks in libraries that end the program (that a pointer is not null, that a
/// function is set) are left out like other exceptions: a reader of the source
/// does not see them.
class Flow {
public:
  /// A copy of a block for a path on which its successor is known before the
  /// block is entered.
  struct Copy {
    const llvm::BasicBlock *BB, *Next;
    unsigned Node;
  };

  Flow(llvm::Function &F, UserSources &Sources, const ThrowsResult &Thrown);

  unsigned idOf(const llvm::BasicBlock *BB) const { return Id.lookup(BB); }

  /// The blocks in order; the index of a block is the number of its node.
  llvm::SmallVector<llvm::BasicBlock *, 32> Blocks;
  FlowGraph Plain;
  /// The graph in which an edge into a block leads to a copy of the block if
  /// the edge decides its successor. In Plain, only the edges of exceptions do.
  FlowGraph Threaded;
  llvm::SmallVector<Copy, 8> Copies;
  size_t NumThrown = 0; ///< The first NumThrown copies are for exceptions.
  /// Blocks that are also entered where their successor is open, or by
  /// exceptions.
  std::vector<bool> Entered;
  LeftInside Left;
  /// For each node of Plain, the instruction that decides at its end, or null.
  std::vector<llvm::Instruction *> Decider;
  /// The part of a block behind a call.
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
  /// Blocks reached by the exceptions of calls that are not taken to throw.
  llvm::DenseSet<const llvm::BasicBlock *> Implicit;
  /// Blocks reached by the exceptions of calls that are taken to throw.
  llvm::DenseSet<const llvm::BasicBlock *> Explicit;
};

} // namespace tpc

#endif // TPC_FLOW_H
