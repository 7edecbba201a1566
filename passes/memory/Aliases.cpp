//===- Aliases.cpp --------------------------------------------------------===//
#include "memory/Aliases.h"

#include "support/Budget.h"
#include "support/Functions.h"

#include "llvm/ADT/SmallPtrSet.h"
#include "llvm/IR/InstIterator.h"
#include "llvm/IR/Operator.h"

using namespace llvm;

namespace tpc {

AnalysisKey AliasesAnalysis::Key;

Aliases AliasesAnalysis::run(Module &M, ModuleAnalysisManager &AM) {
  return Aliases(M, AM.getResult<SimpleCallGraph>(M),
                 AM.getResult<LocationTypesAnalysis>(M));
}

Aliases::Aliases(Module &M, const CallGraphResult &Calls, LocationTypes &Types)
    : Types(Types) {
  findEscaped(M, Calls);
}

/// A local escapes if its address is stored or returned, or passed to a
/// function whose body is analysed.
void Aliases::findEscaped(Module &M, const CallGraphResult &Calls) {
  for (Function &F : definedFunctions(M))
    for (Instruction &I : instructions(F)) {
      if (!isa<AllocaInst>(&I))
        continue;
      if (Budget::isSpent())
        return;
      SmallVector<const Value *, 8> Work{&I};
      SmallPtrSet<const Value *, 8> Seen;
      while (!Work.empty()) {
        const Value *V = Work.pop_back_val();
        if (!Seen.insert(V).second)
          continue;
        for (const Use &U : V->uses()) {
          const auto *User = cast<Instruction>(U.getUser());
          const auto *Call = dyn_cast<CallBase>(User);
          // A merge of pointers is followed like one of them.
          if (isa<GEPOperator>(User) || isa<CastInst>(User) ||
              isa<PHINode>(User) || isa<SelectInst>(User) ||
              isa<FreezeInst>(User) || isa<InsertValueInst>(User) ||
              isa<ExtractValueInst>(User))
            Work.push_back(User);
          else if (isa<ReturnInst>(User) ||
                   (isa<StoreInst>(User) && U.getOperandNo() == 0) ||
                   (Call && !Calls.callees(*Call).empty()))
            Escaped.insert(&I);
        }
      }
    }
}

bool Aliases::isReachable(const Location &L) const {
  return !L.Root || !isa<AllocaInst>(L.Root) || Escaped.contains(L.Root);
}

bool Aliases::mayBe(const Location &A, const Location &B) const {
  if (!A.Root != !B.Root && !isReachable(A.Root ? A : B))
    return false;
  return A.mayBe(B);
}

std::optional<SmallVector<Step, 4>> Aliases::partOf(const Location &Object,
                                                    const Location &L) const {
  ArrayRef<Step> Path = L.Path;
  if (Object.Root && L.Root) {
    if (Object.Root != L.Root || !Object.RootItem.mayBe(L.RootItem) ||
        Path.size() < Object.Path.size() ||
        !StepPath::mayEqual(Path.take_front(Object.Path.size()), Object.Path))
      return std::nullopt;
    return SmallVector<Step, 4>(Path.drop_front(Object.Path.size()));
  }
  // A location with a root and one without can only meet if the first is
  // reachable.
  if (!isReachable(Object.Root ? Object : L))
    return std::nullopt;
  for (size_t K = 1; K <= Path.size() && !Object.Path.empty(); ++K) {
    ArrayRef<Step> Front = Path.take_front(K);
    if ((!Object.Root && endsWith(Front, Object.Path)) ||
        (!L.Root && endsWith(Object.Path, Front)))
      return SmallVector<Step, 4>(Path.drop_front(K));
  }
  if (!L.Root && !Path.empty() && Types.contains(Object, Path[0]))
    return SmallVector<Step, 4>(Path);
  return std::nullopt;
}

} // namespace tpc
