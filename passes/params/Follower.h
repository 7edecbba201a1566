//===- Follower.h - Follows the value of a parameter ----------------------===//
#ifndef TPC_FOLLOWER_H
#define TPC_FOLLOWER_H

#include "Rules.h"
#include "calls/SimpleCallGraph.h"
#include "memory/Variables.h"
#include "memory/VisibleWrites.h"
#include "params/Configured.h"
#include "params/ParamCallFinder.h"
#include "params/ParamUsageFinder.h"
#include "params/Registers.h"
#include "params/TextUsage.h"

#include "llvm/ADT/DenseMap.h"
#include "llvm/ADT/DenseSet.h"

#include <array>
#include <memory>

namespace tpc {

/// The calls by which a value entered functions, the last one first.
struct CallPath {
  const llvm::CallBase *Call;
  const CallPath *Outer;
  unsigned Depth;
};

/// Follows values forward: the value of a parameter to the comparisons, and the
/// outcome of a comparison to the predicates.
class Follower {
public:
  Follower(llvm::Module &M, llvm::ModuleAnalysisManager &AM)
      : Calls(AM.getResult<SimpleCallGraph>(M)),
        Pointers(AM.getResult<PointsToAnalysis>(M)),
        Accesses(AM.getResult<ClassObjectAccess>(M)),
        Writes(AM.getResult<VisibleWritesAnalysis>(M)),
        Reads(AM.getResult<ParamCallFinder>(M)),
        Rules(AM.getResult<RuleAnalysis>(M)),
        Names(AM.getResult<LocationTypesAnalysis>(M)), Texts(M, AM),
        Configuration(Reads, Calls, Pointers, Writes) {}

  ParameterUsage run();

  /// What a store writes to, whatever the value.
  struct Stored {
    size_t Targets;
    llvm::SmallVector<llvm::LoadInst *, 8> Loads;
    llvm::SmallVector<ScalarPart, 1> Written;
  };

private:
  struct State {
    llvm::Value *V;
    Transform How;
    const CallPath *Path;
    bool Direct; ///< of an outcome: see Decision
    /// If V holds several numbers: the bits that are this one.
    std::optional<Bits> In = std::nullopt;
    /// If a phi merged V with other values: the last value before that.
    llvm::Value *Origin = nullptr;
    /// V was already reached from another Origin; what V decides counts for
    /// this one too.
    bool IsAnotherOrigin = false;
    unsigned Way = Hop::None; ///< number of the hop that led here
  };
  /// Ordered by kind of Transform: a value that is reached on several paths is
  /// followed further with the simplest arithmetic.
  class Worklist {
  public:
    void push(State S) {
      Transform::KindTy Kind = S.How.kind();
      ByKind[Kind].push_back(std::move(S));
    }
    std::optional<State> pop() {
      for (llvm::SmallVector<State, 16> &Of : ByKind)
        if (!Of.empty())
          return Of.pop_back_val();
      return std::nullopt;
    }

  private:
    std::array<llvm::SmallVector<State, 16>, Transform::WithVariables + 1>
        ByKind;
  };

  void followRead(unsigned N);
  void addDecision(const State &S, llvm::Instruction &Predicate, unsigned Read);
  void followUseOfMerged(const State &S, llvm::Use &U, unsigned Read);
  void followUse(const State &S, llvm::Use &U, unsigned Read);
  void addComparison(const State &S, llvm::CmpInst &Compare, unsigned Operand,
                     unsigned Read);
  bool holdsInOneCall(const State &S, const llvm::Value *Compared,
                      const llvm::Function &F) const;
  void dropOwnSides(size_t From);
  void addFlag(const State &S, llvm::Value *V, Decision D, unsigned Read,
               bool IsOperand = false);
  void addTexts(unsigned N, const Locations &Objects, const Transform &How);
  void followText(unsigned N);
  void followList(unsigned N);
  void followAll(unsigned N);
  llvm::SmallVector<Decision, 2> followOutcome(llvm::Value *Outcome,
                                               const CallPath *Path);
  bool keepsFormula(const Stored &To) const;
  ValueEnd::KindTy endWithoutLoad(llvm::ArrayRef<ScalarPart> Written);
  bool followHeld(const State &S, llvm::Instruction &I);
  bool isOneVariable(const llvm::Value *A, const llvm::Value *B) const;
  bool limitsMeasured(const llvm::Instruction &Merge);
  bool limitsVariable(const llvm::Instruction &Merge,
                      llvm::function_ref<bool(const llvm::Value *)> IsOwn);
  bool limitsVariable(const llvm::StoreInst &Store);
  bool isThresholdIn(const llvm::StoreInst &Store);
  bool followRepacked(const State &S, llvm::Use &U);
  bool carry(const State &S, llvm::Use &U);
  void load(const State &S, llvm::Instruction &Write,
            llvm::ArrayRef<ScalarPart> Written,
            llvm::ArrayRef<llvm::LoadInst *> Loads);
  const Stored &describeStore(llvm::StoreInst &Store);
  void store(const State &S, llvm::StoreInst &Store);
  void stopAt(ValueEnd::KindTy Kind, llvm::Instruction *At);
  /// Nobody asks for the path of a value that is never compared.
  void forgetHops(size_t From) {
    Usage.Hops.erase(Usage.Hops.begin() + static_cast<ptrdiff_t>(From),
                     Usage.Hops.end());
  }
  void push(State S, llvm::Instruction *Via = nullptr);
  const CallPath *enterCall(const llvm::CallBase *Call, const CallPath *Outer);
  static std::pair<const llvm::Value *, const llvm::CallBase *>
  placeOf(const State &S) {
    return {S.V, S.Path ? S.Path->Call : nullptr};
  }
  std::optional<State> takeNext();

  const CallGraphResult &Calls;
  PointsTo &Pointers;
  AccessIndex &Accesses;
  VisibleWrites &Writes;
  const ParamCallFinder::Result &Reads;
  const RuleMatches &Rules;
  const VariableNames Names;
  const TextUsage Texts;
  Configured Configuration;

  // Very many values may reach one place.
  llvm::DenseMap<const llvm::StoreInst *, std::unique_ptr<Stored>> Stores;
  llvm::DenseMap<const llvm::LoadInst *,
                 std::unique_ptr<llvm::SmallVector<ScalarPart, 1>>>
      Parts;
  llvm::DenseMap<const llvm::PHINode *, bool> Stepped;

  ParameterUsage Usage;
  Worklist Work;
  unsigned ReadAtHand = 0;
  bool IsOutcome = false;    ///< an outcome is followed, not the value itself
  unsigned Here = Hop::None; ///< the hop that led to the current state
  /// The simplest arithmetic with which a value was reached, for each call.
  llvm::DenseMap<std::pair<const llvm::Value *, const llvm::CallBase *>,
                 Transform::KindTy>
      Seen;
  llvm::DenseSet<std::pair<const llvm::Value *, const llvm::Value *>>
      SeenOrigins;
  llvm::SmallVector<std::unique_ptr<CallPath>, 16> Paths;
};

/// \p How, extended if \p I, a phi, select or load, takes the smaller or the
/// larger of the value and a constant.
Transform throughChoice(Transform How, const llvm::Instruction &I);

} // namespace tpc

#endif // TPC_FOLLOWER_H
