//===- Reaching.cpp -------------------------------------------------------===//
#include "memory/Reaching.h"

#include "support/Functions.h"
#include "support/Names.h"

#include "llvm/ADT/SmallPtrSet.h"
#include "llvm/IR/CFG.h"
#include "llvm/IR/InstIterator.h"
#include "llvm/IR/IntrinsicInst.h"
#include "llvm/Support/CommandLine.h"

using namespace llvm;

namespace tpc {

/// The walks go through the callers and callees of a write. Beyond the limit
/// every read sees every write.
static cl::opt<unsigned> MaxWalked(
    "tpc-max-shared-blocks", cl::Hidden, cl::init(5'000'000),
    cl::desc(
        "Basic blocks and functions that are walked for shared variables"));

/// There is one list for each call. A call that can run more functions counts
/// as running all.
static cl::opt<unsigned>
    MaxRun("tpc-max-run", cl::Hidden, cl::init(256),
           cl::desc("Functions that are listed as run by one call"));

/// True for functions without a body in which other threads or callbacks may
/// run.
static bool letsOthersRun(const Function &F) {
  if (waitsByName(F))
    return true;
  std::string Lower = unscoped(qualifiedName(F.getName())).lower();
  StringRef Last = Lower;
  return Last == "call" || Last == "callone" ||
         (Last.ends_with("lock") && !Last.ends_with("clock") &&
          !Last.ends_with("block"));
}

Reaching::Reaching(Module &M, const CallGraphResult &Calls,
                   const ThrowsResult &Thrown, CalledBack &Handed,
                   ArrayRef<Replacement> ByCalls)
    : Layout(M.getDataLayout()), Calls(Calls), Thrown(Thrown),
      Unresolved(Calls.unresolved().begin(), Calls.unresolved().end()),
      Handed(Handed) {
  for (const Function &F : definedFunctions(M)) {
    for (const Instruction *I : Calls.mentions(&F))
      HandedOn[I].push_back(&F);
    if (!Calls.mentions(&F).empty())
      AllHandedOn.push_back(&F);
  }
  for (const Replacement &R : ByCalls)
    if (std::optional<Variable> V = variableAt(R.Pointer, R.Bytes))
      Replacing.insert({R.Call, *V});
}

std::optional<Reaching::Variable> Reaching::variableAt(const Value *Pointer,
                                                       uint64_t Bytes) const {
  APInt Offset(Layout.getIndexTypeSizeInBits(Pointer->getType()), 0);
  const Value *Base = Pointer->stripAndAccumulateConstantOffsets(
      Layout, Offset, /*AllowNonInbounds=*/true);
  if (!Bytes || (!isa<Argument>(Base) && !isa<GlobalVariable>(Base) &&
                 !isa<AllocaInst>(Base)))
    return std::nullopt;
  return Variable{{Base, Offset.getSExtValue()}, Bytes};
}

std::optional<Reaching::Variable>
Reaching::replacedBy(const Instruction &Write) const {
  if (const auto *Store = dyn_cast<StoreInst>(&Write)) {
    TypeSize Bytes =
        Layout.getTypeStoreSize(Store->getValueOperand()->getType());
    return variableAt(Store->getPointerOperand(),
                      Bytes.isScalable() ? 0 : Bytes.getFixedValue());
  }
  const auto *Call = dyn_cast<CallBase>(&Write);
  auto It = Call ? Replacing.find(Call) : Replacing.end();
  if (It == Replacing.end())
    return std::nullopt;
  return It->second;
}

const Reaching::Replacements &Reaching::replacementsIn(const Function &F) {
  std::unique_ptr<Replacements> &Known = ByFunction[&F];
  if (Known)
    return *Known;
  Known = std::make_unique<Replacements>();
  for (const Instruction &I : instructions(F))
    if (std::optional<Variable> V = replacedBy(I)) {
      Known->ByPlace[V->Where].push_back(&I);
      Known->ByBase[V->Where.first].push_back(&I);
    }
  return *Known;
}

const Reaching::Ends &Reaching::endsOf(const Function &F, Variable V) {
  auto &Known = EndsByPlace[{&F, V.Where}];
  auto *It =
      find_if(Known, [&](const auto &Own) { return Own.first == V.Bytes; });
  if (It != Known.end())
    return *It->second;
  auto Found = std::make_unique<Ends>();
  if (auto Own = replacementsIn(F).ByPlace.find(V.Where);
      Own != replacementsIn(F).ByPlace.end())
    for (const Instruction *I : Own->second)
      if (replacedBy(*I)->Bytes >= V.Bytes) {
        Found->All.push_back(I);
        Found->In[I->getParent()].push_back(I);
      }
  Known.push_back({V.Bytes, std::move(Found)});
  return *Known.back().second;
}

bool Reaching::isTooMuch() {
  bool TooMuch = Walked > MaxWalked;
  GivenUp += TooMuch;
  return TooMuch;
}

Reaching::Instructions Reaching::replacingFrom(const Function &F,
                                               const Value *Base) {
  return replacementsIn(F).ByBase.lookup(Base);
}

//===----------------------------------------------------------------------===//
// What a call can run
//===----------------------------------------------------------------------===//

void Reaching::addRunning(const Instruction &I, Running &Out) {
  if (auto It = HandedOn.find(&I); It != HandedOn.end())
    Out.Functions.insert(It->second.begin(), It->second.end());
  const auto *Call = dyn_cast<CallBase>(&I);
  if (!Call)
    return;
  for (const Function *Callee : Calls.callees(*Call))
    Out.Functions.insert(Callee);
  const Function *Callee = Call->getCalledFunction();
  Out.Anything |=
      Unresolved.contains(Call) ||
      (Callee && Callee->isDeclarationForLinker() && letsOthersRun(*Callee));
  for (const CalledBack::Callable *Object : Handed.handedBy(*Call)) {
    Out.Anything |=
        Object->Unknown || (Object->Kept && AllHandedOn.size() > MaxRun);
    if (Out.Anything)
      return;
    Out.Functions.insert(Object->Virtual.begin(), Object->Virtual.end());
    if (Object->Kept)
      Out.Functions.insert(AllHandedOn.begin(), AllHandedOn.end());
  }
}

ArrayRef<const Instruction *> Reaching::runnersIn(const BasicBlock &BB) {
  auto [It, New] = Runners.try_emplace(&BB);
  if (New)
    for (const Instruction &I : BB)
      if ((isa<CallBase>(I) && !isa<IntrinsicInst>(I)) || HandedOn.contains(&I))
        It->second.push_back(&I);
  return It->second;
}

const Reaching::Running &Reaching::runBy(const Function &F) {
  std::unique_ptr<Running> &Known = RunBy[&F];
  if (!Known) {
    Known = std::make_unique<Running>();
    for (const BasicBlock &BB : F)
      for (const Instruction *I : runnersIn(BB))
        addRunning(*I, *Known);
  }
  return *Known;
}

bool Reaching::canRun(Way &W, const Function &F) {
  if (!W.Closure) {
    Running All;
    for (const Instruction *I : W.Runners)
      addRunning(*I, All);
    for (unsigned N = 0; N < All.Functions.size() && !All.Anything; ++N) {
      const Running &Inner = runBy(*All.Functions[N]);
      All.Anything |= Inner.Anything || All.Functions.size() > MaxRun ||
                      ++Walked > MaxWalked;
      All.Functions.insert(Inner.Functions.begin(), Inner.Functions.end());
    }
    if (All.Anything)
      All.Functions.clear();
    W.Closure = std::make_unique<Running>(std::move(All));
  }
  return W.Closure->Anything || W.Closure->Functions.contains(&F);
}

//===----------------------------------------------------------------------===//
// The walks: from a write down, from a read up
//===----------------------------------------------------------------------===//

/// Goes through \p BB from below \p From, or from its beginning; false if the
/// value of \p Write is replaced.
bool Reaching::walkDown(const BasicBlock &BB, const Instruction *From,
                        const Instruction &Write, const Ends &At, Way &Out) {
  ArrayRef<const Instruction *> Own = At.of(BB);
  const auto *First = find_if(Own, [&](const Instruction *I) {
    return I != &Write && (!From || From->comesBefore(I));
  });
  const Instruction *End = First == Own.end() ? nullptr : *First;
  for (const Instruction *I : runnersIn(BB))
    if ((!From || From->comesBefore(I)) && (!End || I->comesBefore(End))) {
      Out.Runners.push_back(I);
      // An exception thrown by an `invoke` may overwrite it on its way out.
      const auto *Call = dyn_cast<CallInst>(I);
      Out.Open |= Call && Thrown.leaves(*Call);
    }
  return !End;
}

/// True if control leaves the function at the end of \p BB, by return or by
/// `throw`. False if the program ends there.
static bool isExit(const BasicBlock &BB) {
  const Instruction *End = BB.getTerminator();
  if (!isa<UnreachableInst>(End))
    return End->getNumSuccessors() == 0;
  const auto *Last = dyn_cast_or_null<CallBase>(End->getPrevNode());
  return !Last || !Last->doesNotThrow();
}

Reaching::Way &Reaching::after(const Instruction &Write,
                               std::optional<Variable> V) {
  const auto *Store = dyn_cast<StoreInst>(&Write);
  if (!V || (Store && !Store->isSimple()))
    return Everywhere;
  const auto Key = std::pair(std::pair(&Write, V->Where), V->Bytes);
  if (auto It = After.find(Key); It != After.end())
    return *It->second;
  const Ends &All = endsOf(*Write.getFunction(), *V);
  bool HasOthers = any_of(
      All.All, [&](const Instruction *Other) { return Other != &Write; });
  if (!HasOthers || isTooMuch())
    return Everywhere;
  std::unique_ptr<Way> &Known = After[Key];
  Known = std::make_unique<Way>();
  Known->Open = false;
  SmallPtrSet<const BasicBlock *, 8> Seen;
  // The blocks that throw come last. By then the blocks reached without an
  // exception are known; a `resume` in any other block rethrows what \c Leaves
  // the function.
  SmallVector<const BasicBlock *, 8> Work, Pads;
  bool Unwound = false, Leaves = false, Resumes = false;
  auto Through = [&](const BasicBlock &BB, const Instruction *From) {
    ++Walked;
    if (!walkDown(BB, From, Write, All, *Known))
      return;
    const Instruction *End = BB.getTerminator();
    (Unwound && isa<ResumeInst>(End) ? Resumes : Known->Open) |= isExit(BB);
    const auto *Invoke = dyn_cast<InvokeInst>(End);
    if (Invoke && !Thrown.thrownBy(*Invoke).empty()) {
      Pads.push_back(Invoke->getUnwindDest());
      Leaves |= Thrown.leaves(*Invoke);
      if (isThrow(*Invoke))
        return;
    }
    for (const BasicBlock *Next : successors(&BB))
      if (!(Invoke && Next == Invoke->getUnwindDest()) &&
          Seen.insert(Next).second)
        Work.push_back(Next);
  };
  Through(*Write.getParent(), &Write);
  while (!Work.empty() || !Pads.empty()) {
    if (Work.empty()) {
      Unwound = true;
      if (const BasicBlock *Pad = Pads.pop_back_val(); Seen.insert(Pad).second)
        Work.push_back(Pad);
      continue;
    }
    Through(*Work.pop_back_val(), nullptr);
  }
  Known->Open |= Leaves && Resumes;
  return *Known;
}

/// Goes up through \p BB from above \p Below, or from its end; returns the
/// write that replaced the earlier value, or null.
const Instruction *Reaching::walkUp(const BasicBlock &BB,
                                    const Instruction *Below, const Ends &At,
                                    Way &Out) {
  ArrayRef<const Instruction *> Own = At.of(BB);
  auto Last = find_if(reverse(Own), [&](const Instruction *I) {
    return !Below || I->comesBefore(Below);
  });
  const Instruction *End = Last == Own.rend() ? nullptr : *Last;
  for (const Instruction *I : runnersIn(BB))
    if ((!Below || I->comesBefore(Below)) && (!End || End->comesBefore(I)))
      Out.Runners.push_back(I);
  return End;
}

Reaching::Way &Reaching::before(const Instruction &At, Variable V) {
  const auto Key = std::pair(std::pair(&At, V.Where), V.Bytes);
  if (auto It = Before.find(Key); It != Before.end())
    return *It->second;
  const Ends &All = endsOf(*At.getFunction(), V);
  bool IsLocal = isa<AllocaInst>(V.Where.first);
  if ((All.All.empty() && !IsLocal) || isTooMuch())
    return Everywhere;
  std::unique_ptr<Way> &Known = Before[Key];
  Known = std::make_unique<Way>();
  Known->Open = false;
  // A call that throws has replaced nothing.
  auto Thrown = [&](const BasicBlock *BB, const BasicBlock *Next) {
    const auto *Invoke = dyn_cast<InvokeInst>(BB->getTerminator());
    return Invoke && Next == Invoke->getUnwindDest() &&
           is_contained(All.of(*BB), Invoke);
  };
  SmallVector<std::pair<const BasicBlock *, const Instruction *>, 8> Work;
  SmallPtrSet<const BasicBlock *, 8> SeenThrown;
  auto Above = [&](const BasicBlock &BB) {
    // Nobody can write a local before its function begins.
    Known->Open |= !IsLocal && &BB == &BB.getParent()->getEntryBlock();
    for (const BasicBlock *Pred : predecessors(&BB)) {
      bool ByThrow = Thrown(Pred, &BB);
      if (ByThrow ? SeenThrown.insert(Pred).second
                  : !Known->Blocks.contains(Pred))
        Work.push_back({Pred, ByThrow ? Pred->getTerminator() : nullptr});
    }
  };
  Known->UpperEnd = walkUp(*At.getParent(), &At, All, *Known);
  if (!Known->UpperEnd)
    Above(*At.getParent());
  while (!Work.empty()) {
    auto [BB, Below] = Work.pop_back_val();
    if (!Below && Known->Blocks.contains(BB))
      continue;
    ++Walked;
    const Instruction *End = walkUp(*BB, Below, All, *Known);
    // If there are two ways through a block, the longer one counts.
    auto [It, New] = Known->Blocks.try_emplace(BB, End);
    if (!New && Below)
      It->second = End;
    if (!End)
      Above(*BB);
  }
  return *Known;
}

/// True if \p Back, the way back from \p At, reaches \p Write.
bool Reaching::contains(const Way &Back, const Instruction &At,
                        const Instruction &Write) {
  auto NotBefore = [&](const Instruction *End) {
    return !End || End == &Write || End->comesBefore(&Write);
  };
  if (Write.getParent() == At.getParent() && Write.comesBefore(&At) &&
      NotBefore(Back.UpperEnd))
    return true;
  auto It = Back.Blocks.find(Write.getParent());
  return It != Back.Blocks.end() && NotBefore(It->second);
}

bool Reaching::reaches(const Instruction &Write,
                       std::optional<Variable> Written, const Instruction &At,
                       std::optional<Variable> Read) {
  Way &Down = after(Write, Written);
  Way &Up = Read ? before(At, *Read) : Everywhere;
  const Function &F = *Write.getFunction(), &G = *At.getFunction();
  if (&F == &G && (&Up == &Everywhere || contains(Up, At, Write)))
    return true;
  if (Down.Open)
    return Up.Open || canRun(Up, F);
  return Up.Open && canRun(Down, G);
}

} // namespace tpc
