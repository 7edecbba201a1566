//===- Reaching.h - Which reads of a member or global see a write ---------===//
//
// Reaching definitions (Aho, Sethi and Ullman, "Compilers", 10.5) for memory
// that functions share. Inside a function a store replaces the value of an
// earlier store to the same variable of the same object. The value at a return
// is visible to everybody. The value at a call is visible to the functions that
// the call can run; a library function can run what its arguments provide (see
// CalledBack). If a call leads to a `throw` in user code (see Throws), the
// value is visible to the handler; other exceptions are ignored, as in control
// dependence.
//
// Threads: a value that is replaced before the function returns is not seen by
// other threads, unless the function waits, locks or lets callbacks run in
// between, or the store is atomic.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_REACHING_H
#define TPC_REACHING_H

#include "calls/SimpleCallGraph.h"
#include "control/Throws.h"
#include "memory/AccessIndex.h"
#include "memory/CalledBack.h"

#include "llvm/ADT/SetVector.h"
#include "llvm/IR/DataLayout.h"
#include "llvm/IR/Instructions.h"

#include <memory>
#include <optional>

namespace tpc {

class Reaching {
public:
  /// A piece of memory as the code of its function names it: a number of bytes
  /// from the target of an argument, or from the beginning of a global or a
  /// local.
  using Place = std::pair<const llvm::Value *, int64_t>;
  struct Variable {
    Place Where;
    uint64_t Bytes;
  };

  using Instructions = llvm::SmallVector<const llvm::Instruction *, 2>;

  Reaching(llvm::Module &M, const CallGraphResult &Calls,
           const ThrowsResult &Thrown, CalledBack &Handed,
           llvm::ArrayRef<Replacement> ByCalls);

  /// None if \p Pointer is not the same place each time it is computed.
  std::optional<Variable> variableAt(const llvm::Value *Pointer,
                                     uint64_t Bytes) const;

  /// Some part of \p Local that no single write replaces.
  static Variable anywhereIn(const llvm::Value &Local) {
    return {{&Local, -1}, 1};
  }

  /// The variable that \p Write, a store or call, always replaces.
  std::optional<Variable> replacedBy(const llvm::Instruction &Write) const;
  /// All such writes in \p F whose variable is named by \p Base.
  Instructions replacingFrom(const llvm::Function &F, const llvm::Value *Base);

  /// True if the value that \p Write puts into \p Written can still be there
  /// when \p At reads it. \p Read is the variable that \p At names; none if
  /// \p At reads through a pointer that may lead to another object.
  bool reaches(const llvm::Instruction &Write, std::optional<Variable> Written,
               const llvm::Instruction &At, std::optional<Variable> Read);

  /// True if every read that is not itself narrowed sees \p Write.
  bool isVisible(const llvm::Instruction &Write,
                 std::optional<Variable> Written) {
    return after(Write, Written).Open;
  }
  /// True if \p At reads a variable that its function also replaces.
  bool isNarrowed(const llvm::Instruction &At, std::optional<Variable> Read) {
    return Read && !endsOf(*At.getFunction(), *Read).All.empty();
  }
  /// How often the search for the readers of a write was skipped because the
  /// link unit is too large.
  unsigned givenUp() const { return GivenUp; }

private:
  /// The functions that an instruction can run.
  struct Running {
    bool Anything = false;
    /// In the order in which they were found: how far a search gets before it
    /// is given up must not depend on addresses.
    llvm::SmallSetVector<const llvm::Function *, 4> Functions;
  };
  /// The path from a write to the reads that see it, or from a read back to the
  /// writes.
  struct Way {
    bool Open = true; ///< leads out of the function
    llvm::SmallVector<const llvm::Instruction *, 4> Runners;
    /// Of Runners; computed when first needed.
    std::unique_ptr<Running> Closure;
    /// For a path back: its blocks and, for each, the write at which it ends,
    /// or null if it passes through.
    llvm::DenseMap<const llvm::BasicBlock *, const llvm::Instruction *> Blocks;
    const llvm::Instruction *UpperEnd = nullptr; ///< in the block of the read
  };
  /// The writes in a function that replace the whole variable, and those of
  /// each block, in order.
  struct Ends {
    Instructions All;
    llvm::DenseMap<const llvm::BasicBlock *, Instructions> In;
    llvm::ArrayRef<const llvm::Instruction *>
    of(const llvm::BasicBlock &BB) const {
      auto It = In.find(&BB);
      return It == In.end() ? llvm::ArrayRef<const llvm::Instruction *>()
                            : llvm::ArrayRef(It->second);
    }
  };
  const Ends &endsOf(const llvm::Function &F, Variable V);
  bool isTooMuch();
  Way &after(const llvm::Instruction &Write, std::optional<Variable> V);
  Way &before(const llvm::Instruction &At, Variable V);
  static bool contains(const Way &Back, const llvm::Instruction &At,
                       const llvm::Instruction &Write);
  bool canRun(Way &W, const llvm::Function &F);
  void addRunning(const llvm::Instruction &I, Running &Out);
  const Running &runBy(const llvm::Function &F);
  llvm::ArrayRef<const llvm::Instruction *>
  runnersIn(const llvm::BasicBlock &BB);
  bool walkDown(const llvm::BasicBlock &BB, const llvm::Instruction *From,
                const llvm::Instruction &Write, const Ends &At, Way &Out);
  const llvm::Instruction *walkUp(const llvm::BasicBlock &BB,
                                  const llvm::Instruction *Below,
                                  const Ends &At, Way &Out);

  const llvm::DataLayout &Layout;
  const CallGraphResult &Calls;
  const ThrowsResult &Thrown;
  llvm::DenseSet<const llvm::CallBase *> Unresolved;
  llvm::DenseMap<const llvm::CallBase *, Variable> Replacing;
  CalledBack &Handed;
  /// The functions whose address each instruction passes on, and all of them
  /// together.
  llvm::DenseMap<const llvm::Instruction *,
                 llvm::SmallVector<const llvm::Function *, 1>>
      HandedOn;
  llvm::SmallVector<const llvm::Function *, 0> AllHandedOn;
  /// For each function: the writes that replace a variable, in order.
  struct Replacements {
    llvm::DenseMap<Place, Instructions> ByPlace;
    llvm::DenseMap<const llvm::Value *, Instructions> ByBase;
  };
  const Replacements &replacementsIn(const llvm::Function &F);
  llvm::DenseMap<const llvm::Function *, std::unique_ptr<Replacements>>
      ByFunction;
  llvm::DenseMap<const llvm::BasicBlock *, Instructions> Runners;
  llvm::DenseMap<const llvm::Function *, std::unique_ptr<Running>> RunBy;
  llvm::DenseMap<
      std::pair<std::pair<const llvm::Instruction *, Place>, uint64_t>,
      std::unique_ptr<Way>>
      After, Before;
  Way Everywhere; ///< used if nothing is known
  llvm::DenseMap<
      std::pair<const llvm::Function *, Place>,
      llvm::SmallVector<std::pair<uint64_t, std::unique_ptr<Ends>>, 1>>
      EndsByPlace;
  unsigned Walked = 0, GivenUp = 0;
};

} // namespace tpc

#endif // TPC_REACHING_H
