//===- Texts.cpp - Follows a name back to its origin ----------------------===//
#include "params/Texts.h"

#include "calls/ClassHierarchy.h"
#include "support/Names.h"

#include "llvm/Analysis/ConstantFolding.h"
#include "llvm/Analysis/ValueTracking.h"
#include "llvm/IR/CFG.h"
#include "llvm/IR/IntrinsicInst.h"
#include "llvm/IR/Module.h"
#include "llvm/Support/CommandLine.h"
#include "llvm/Support/SaveAndRestore.h"

using namespace llvm;

namespace tpc {

/// The search is recursive, on the stack of the linker.
static cl::opt<unsigned>
    MaxDepth("tpc-max-text-depth", cl::Hidden, cl::init(64),
             cl::desc("Objects in a row that a text is followed through"));
/// Paths through calls and merges multiply.
static cl::opt<unsigned>
    MaxSteps("tpc-max-text-steps", cl::Hidden, cl::init(5000),
             cl::desc("Objects in all that one text is followed through"));
/// Each text walks the blocks of its function: generated functions have very
/// many of both.
static cl::opt<unsigned> MaxBlocks(
    "tpc-max-text-blocks", cl::Hidden, cl::init(2000),
    cl::desc("Basic blocks of a function in which a text is followed"));

/// Adds \p New, found on another path, to \p Into. Where the two differ, the
/// result is unknown.
template <typename Known> static void merge(Known &Into, const Known &New) {
  if (New.None)
    return;
  if (Into.None) {
    Into = New;
    return;
  }
  Into.Varies |= New.Varies;
  Into.Absolute |= New.Absolute;
  if (Into.Text != New.Text)
    Into.Text = DynamicName;
}

/// What \p Object, a local or an argument of the function, holds above \p I in
/// \p BB; None if nothing on the path sets it.
Texts::Known Texts::above(const Value *Object, const Instruction *I,
                          const BasicBlock *BB, Kind K, Places &Seen) {
  while (true) {
    for (; I; I = I->getPrevNode()) {
      const auto *Call = dyn_cast<CallBase>(I);
      if (!Call || isa<IntrinsicInst>(Call))
        continue;
      for (const auto &[N, Arg] : enumerate(Call->args())) {
        if (Arg != Object)
          continue;
        std::optional<Effect> E = effect(*Call, N, K);
        if (!E)
          return unknown(K);
        if (E->Does == Effect::Clears)
          return {""};
        if (E->Does == Effect::Sets)
          return E->To;
      }
    }
    if (Seen.size() > MaxBlocks)
      return unknown(K);
    const BasicBlock *Only = BB->getSinglePredecessor();
    if (!Only)
      break;
    // A block that is reached again around a loop adds nothing.
    if (!Seen.try_emplace(Only, Known{"", false, true}).second)
      return Seen[Only];
    BB = Only;
    I = &BB->back();
  }
  Known All{"", false, true};
  for (const BasicBlock *Pred : predecessors(BB)) {
    auto [It, New] = Seen.try_emplace(Pred, Known{"", false, true});
    if (New) {
      Known Found = above(Object, &Pred->back(), Pred, K, Seen);
      Seen[Pred] = Found;
    }
    merge(All, Seen[Pred]);
  }
  return All;
}

Texts::Known Texts::local(const Value *Object, const Instruction &At, Kind K) {
  Places Seen;
  return above(Object, At.getPrevNode(), At.getParent(), K, Seen);
}

/// What \p Call passes as \p Arg; null if that is not known: the arguments of a
/// callback come from elsewhere.
static const Value *passedAs(const Argument &Arg, const CallBase &Call) {
  const bool IsOwn = Call.getCalledFunction() == Arg.getParent() ||
                     ClassHierarchy::match(Call);
  return IsOwn && Arg.getArgNo() < Call.arg_size()
             ? Call.getArgOperand(Arg.getArgNo())
             : nullptr;
}

/// What the calls of its function pass as \p Arg.
Texts::Known Texts::ofArgument(const Argument &Arg, Kind K) {
  auto [It, New] = Arguments.try_emplace(&Arg, Known{"", false, true});
  if (!New)
    return It->second;
  const Function *F = Arg.getParent();
  Known All{"", false, true};
  bool Differ = false;
  for (const CallBase *Call : Calls.callers(F)) {
    const Value *Passed = passedAs(Arg, *Call);
    Known One = Passed ? find(Passed, *Call, K) : unknown(K);
    if (One.None)
      continue;
    Differ |= !All.None && All.Text != One.Text;
    merge(All, One);
  }
  if (All.None)
    All = unknown(K);
  All.Varies |= Differ;
  if (All.Varies)
    Shared.insert(F);
  return Arguments[&Arg] = All;
}

/// What the function that \p Call enters returns.
Texts::Known Texts::returned(const CallBase &Call, Kind K) {
  Known All{"", false, true};
  for (const Function *F : Calls.callees(Call))
    for (const BasicBlock &BB : *F) {
      const auto *Return = dyn_cast<ReturnInst>(BB.getTerminator());
      if (!Return)
        continue;
      Known One = Call.hasStructRetAttr()
                      ? local(F->getArg(0), *Return, K)
                      : find(Return->getReturnValue(), *Return, K);
      merge(All, One.None ? unknown(K) : One);
    }
  return All.None ? unknown(K) : All;
}

/// What the pointer that \p Call returns leads to.
Texts::Known Texts::ofResult(const CallBase &Call, Kind K) {
  const Function *F = Call.getCalledFunction();
  if (!F)
    return unknown(K);
  if (const Rule *Row = Rules.match(Call); Row && Row->Kind == Rule::Naming)
    return joined(Call, *Row);
  StringRef Name = calleeOf(*F).Name;
  if (Name.consume_front("std::__cxx11::basic_string::")) {
    if (Name == "c_str" || Name == "data")
      return find(Call.getArgOperand(0), Call, K);
    // Methods that change a string return it.
    std::optional<Effect> E = ofString(Call, Name);
    return E && E->Does == Effect::Sets ? E->To : unknown(K);
  }
  if (!Calls.callees(Call).empty())
    return returned(Call, K);
  // A new object is what its constructor makes of it.
  Known All{"", false, true};
  for (const Use &U : Call.uses()) {
    const auto *User = dyn_cast<CallBase>(U.getUser());
    if (!User || !User->isArgOperand(&U))
      continue;
    std::optional<Effect> E = effect(*User, User->getArgOperandNo(&U), K);
    if (E && E->Does == Effect::Sets)
      merge(All, E->To);
  }
  return All.None ? unknown(K) : All;
}

/// The combined values of all writes of the member or global \p L. That it was
/// empty before does not count.
Texts::Known Texts::ofMember(const Location &L, Kind K) {
  if (auto *It = find_if(Members, [&](auto &M) { return M.first.isSame(L); });
      It != Members.end())
    return It->second;
  size_t Mine = Members.size();
  Members.push_back({L, Known{"", false, true}});
  Known All{"", false, true};
  bool Cleared = false;
  for (const Instruction *W : Memory->Accesses.writesInto(L)) {
    const auto *Call = dyn_cast<CallBase>(W);
    if (!Call || isa<IntrinsicInst>(Call))
      continue;
    bool Entered = !Calls.callees(*Call).empty();
    for (const auto &[N, Arg] : enumerate(Call->args())) {
      // The calls inside an analysed function show what it does.
      if (!Arg->getType()->isPointerTy() ||
          (Entered && !(N == 0 && Call->hasStructRetAttr())) ||
          none_of(Memory->Pointers.resolve(Arg, false),
                  [&](const Location &O) { return O.mayBe(L); }))
        continue;
      std::optional<Effect> E = effect(*Call, N, K);
      if (!E)
        merge(All, {DynamicName});
      else if (E->Does == Effect::Sets)
        merge(All, E->To);
      else
        Cleared |= E->Does == Effect::Clears;
    }
  }
  if (All.None)
    All = Cleared ? Known{""} : unknown(K);
  return Members[Mine].second = All;
}

Texts::Known Texts::inMemory(const Value *Pointer, Kind K) {
  if (!Memory)
    return unknown(K);
  Known All{"", false, true};
  bool Any = false;
  for (const Location &L : Memory->Pointers.resolve(Pointer, false)) {
    Any = true;
    merge(All, ofMember(L, K));
  }
  return Any ? All : unknown(K);
}

/// What the pointer that \p Load reads leads to.
Texts::Known Texts::loaded(const LoadInst &Load, Kind K) {
  const DataLayout &Layout = Load.getModule()->getDataLayout();
  if (auto *C = dyn_cast<Constant>(Load.getPointerOperand()))
    if (Constant *Folded = ConstantFoldLoadFromConstPtr(
            const_cast<Constant *>(C), Load.getType(), Layout))
      return find(Folded, Load, K);
  if (!Memory)
    return unknown(K);
  Known All{"", false, true};
  for (const Instruction *W : Memory->Writes.definitionsOf(Load)) {
    const auto *Store = dyn_cast<StoreInst>(W);
    merge(All, Store ? find(Store->getValueOperand(), *Store, K)
                     : Known{DynamicName});
  }
  const auto *Global = dyn_cast<GlobalVariable>(Load.getPointerOperand());
  if (All.None && Global && Global->hasLocalLinkage() &&
      Global->hasInitializer())
    return find(Global->getInitializer(), Load, K);
  return All.None ? unknown(K) : All;
}

Texts::Known Texts::follow(const Value *P, const Instruction &At, Kind K) {
  if (const auto *Arg = dyn_cast<Argument>(P)) {
    Known Here = local(Arg, At, K);
    return Here.None ? ofArgument(*Arg, K) : Here;
  }
  if (isa<AllocaInst>(P)) {
    Known Here = local(P, At, K);
    return Here.None ? inMemory(P, K) : Here;
  }
  if (const auto *Call = dyn_cast<CallBase>(P))
    return ofResult(*Call, K);
  if (const auto *Load = dyn_cast<LoadInst>(P))
    return loaded(*Load, K);
  Known All{"", false, true};
  if (const auto *Phi = dyn_cast<PHINode>(P)) {
    for (unsigned N = 0; N < Phi->getNumIncomingValues(); ++N)
      merge(All, find(Phi->getIncomingValue(N),
                      *Phi->getIncomingBlock(N)->getTerminator(), K));
    return All;
  }
  if (const auto *Select = dyn_cast<SelectInst>(P)) {
    merge(All, find(Select->getTrueValue(), At, K));
    merge(All, find(Select->getFalseValue(), At, K));
    return All;
  }
  return inMemory(P, K);
}

Texts::Known Texts::find(const Value *Pointer, const Instruction &At, Kind K) {
  StringRef Plain;
  if (K == Kind::Text && getConstantStringInfo(Pointer, Plain))
    return {Plain.str()};
  if (Depth == MaxDepth || ++Steps > MaxSteps)
    return {DynamicName};
  SaveAndRestore Deeper(Depth, Depth + 1);
  // A null pointer leads to no object.
  if (isa<ConstantPointerNull>(Pointer))
    return {"", false, true};
  return follow(Pointer, At, K);
}

//===----------------------------------------------------------------------===//
// Queries
//===----------------------------------------------------------------------===//

Texts::Known Texts::knownAt(const Value *Pointer, const Instruction &At) {
  if (!Pointer || !Pointer->getType()->isPointerTy())
    return unknown(Kind::Text);
  Steps = 0;
  Known K = find(Pointer, At, Kind::Text);
  return K.None ? unknown(Kind::Text) : K;
}

std::string Texts::textAt(const Value *Pointer, const Instruction &At) {
  return knownAt(Pointer, At).Text;
}

std::string Texts::nameOf(const CallBase &Call, const Rule &Row) {
  Known Name = knownAt(argument(Call, Row, Row.Name), Call);
  return Name.Absolute ? Name.Text
                       : joinNames(namespaceOf(Call, Row), Name.Text);
}

std::string Texts::namespaceOf(const CallBase &Call, const Rule &Row) {
  const Value *Handle = Row.Handle ? objectOf(Call, Row) : nullptr;
  if (!Handle)
    return "";
  Steps = 0;
  return find(Handle, Call, Kind::Handle).Text;
}

const Constant *Texts::constantOf(const Value *V) {
  // Limited, because an argument may be passed on from an argument.
  for (unsigned N = 0; N < MaxDepth; ++N) {
    if (const auto *Global = dyn_cast<GlobalVariable>(V))
      return Global->isConstant() && Global->hasInitializer()
                 ? Global->getInitializer()
                 : nullptr;
    if (const auto *C = dyn_cast<Constant>(V))
      return C;
    const Value *Next = nullptr;
    // In memory a bool is a byte.
    if (const auto *Wide = dyn_cast<ZExtInst>(V);
        Wide && Wide->getSrcTy()->isIntegerTy(1))
      Next = Wide->getOperand(0);
    else if (const auto *Arg = dyn_cast<Argument>(V)) {
      // If calls pass different values, none is the default.
      for (const CallBase *Call : Calls.callers(Arg->getParent())) {
        const Value *Passed = passedAs(*Arg, *Call);
        if (!Passed || (Next && Next != Passed))
          return nullptr;
        Next = Passed;
      }
    } else if (isa<AllocaInst>(V)) {
      // A temporary that one value is stored to, or that one value is converted
      // into.
      for (const User *U : V->users()) {
        const auto *Store = dyn_cast<StoreInst>(U);
        const auto *Call = dyn_cast<CallBase>(U);
        const Value *One = Store ? Store->getValueOperand() : nullptr;
        if (Call && Call->arg_size() == 2 && Call->getArgOperand(0) == V)
          One = dyn_cast<Constant>(Call->getArgOperand(1));
        if (One && Next && Next != One)
          return nullptr;
        if (One)
          Next = One;
      }
    }
    if (!Next)
      return nullptr;
    V = Next;
  }
  return nullptr;
}

} // namespace tpc
