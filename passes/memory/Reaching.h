//===- Reaching.h - Which reads of a member or global see a write ---------===//
//
// Reaching definitions (Aho, Sethi and Ullman, "Compilers", 10.5) for memory
// that functions share. Inside a function a store replaces what an earlier one
// put into the same variable of the same object. What is there when a function
// returns is visible to everybody, what is there at a call to what the call can
// run: a library's function what it is handed (see CalledBack). Where a call
// leads to a `throw` of the user's (see Throws), what is there is visible to
// the handler; other exceptions make no way, as for control dependence.
//
// Threads: what is replaced before the function returns is seen by no other
// thread, unless the function waits, locks or lets callbacks run in between,
// or the store is atomic.
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
  /// Where a piece of memory is by the code of its function: so many bytes from
  /// what an argument points to, from a global's or a local's beginning.
  using Place = std::pair<const llvm::Value *, int64_t>;
  struct Variable {
    Place Where;
    uint64_t Bytes;
  };

  using Instructions = llvm::SmallVector<const llvm::Instruction *, 2>;

  Reaching(llvm::Module &M, const CallGraphResult &Calls,
           const ThrowsResult &Thrown, DebugTypes &Debug,
           llvm::ArrayRef<Replacement> ByCalls);

  /// None where \p Pointer is not the same place whenever it is computed.
  std::optional<Variable> variableAt(const llvm::Value *Pointer,
                                     uint64_t Bytes) const;

  /// Some part of \p Local that no single write replaces.
  static Variable anywhereIn(const llvm::Value &Local) {
    return {{&Local, -1}, 1};
  }

  /// What \p Write, a store or call, always replaces.
  std::optional<Variable> replacedBy(const llvm::Instruction &Write) const;
  /// All such writes in \p F that name their variable by \p Base.
  Instructions replacingFrom(const llvm::Function &F, const llvm::Value *Base);

  /// True where what \p Write puts into \p Written can still be there when
  /// \p Read reads it, which names the variable \p Read (none: by a pointer
  /// that may be another object's).
  bool reaches(const llvm::Instruction &Write, std::optional<Variable> Written,
               const llvm::Instruction &At, std::optional<Variable> Read);

  /// True where every read that is not itself narrowed sees \p Write.
  bool isVisible(const llvm::Instruction &Write,
                 std::optional<Variable> Written) {
    return after(Write, Written).Open;
  }
  /// True where \p At reads a variable that its function also replaces.
  bool isNarrowed(const llvm::Instruction &At, std::optional<Variable> Read) {
    return Read && !endsOf(*At.getFunction(), *Read).All.empty();
  }
  /// How often it was not looked who sees a write, for the unit is too large.
  unsigned givenUp() const { return GivenUp; }

private:
  /// What instructions can run besides themselves.
  struct Running {
    bool Anything = false;
    /// In the order in which they were found: how far a search comes before
    /// it is given up must not depend on addresses.
    llvm::SmallSetVector<const llvm::Function *, 4> Functions;
  };
  /// The way from a write to where others see it, or from a read back to where
  /// others wrote.
  struct Way {
    bool Open = true; ///< leads out of the function
    llvm::SmallVector<const llvm::Instruction *, 4> Runners;
    /// Of Runners, once it was asked for.
    std::unique_ptr<Running> Closure;
    /// Of a way back: the blocks that it leads through and the write at which
    /// it ends in each, null where it goes through.
    llvm::DenseMap<const llvm::BasicBlock *, const llvm::Instruction *> Blocks;
    const llvm::Instruction *UpperEnd = nullptr; ///< in the block of the read
  };
  /// The writes in a function that replace the whole of a variable, and those
  /// of each block, in order.
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
  CalledBack Handed;
  /// Functions that an instruction hands on, and all of them.
  llvm::DenseMap<const llvm::Instruction *,
                 llvm::SmallVector<const llvm::Function *, 1>>
      HandedOn;
  llvm::SmallVector<const llvm::Function *, 0> AllHandedOn;
  /// Of a function: the writes that replace a variable, in order.
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
  Way Everywhere; ///< where nothing is known
  llvm::DenseMap<
      std::pair<const llvm::Function *, Place>,
      llvm::SmallVector<std::pair<uint64_t, std::unique_ptr<Ends>>, 1>>
      EndsByPlace;
  unsigned Walked = 0, GivenUp = 0;
};

} // namespace tpc

#endif // TPC_REACHING_H
