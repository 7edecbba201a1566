//===- MadeObjects.cpp ----------------------------------------------------===//
#include "params/MadeObjects.h"

#include "params/ManyParameters.h"
#include "support/Names.h"

#include "llvm/IR/CFG.h"
#include "llvm/IR/IntrinsicInst.h"

using namespace llvm;

namespace tpc {

/// True if \p F is a constructor or an assignment: it gives its first argument
/// the value of the second, if there is one.
static bool givesValue(const Function &F) {
  const std::string Name = qualifiedName(F.getName());
  auto [Scope, Own] = StringRef(Name).rsplit("::");
  return Own == "operator=" || (!Own.empty() && Own == unscoped(Scope));
}

void MadeObjects::add(unsigned Read, Value *Made) {
  MadeObject O{Read, Made, {}, {}};
  auto AddPlace = [&](const Value *Pointer) {
    O.Pointers.insert(Pointer);
    if (Reads[Read].Row->Many == Rule::List)
      Pointers.addElements(Pointer, O.Where);
    else
      append_range(O.Where, Pointers.resolve(Pointer, false));
  };
  AddPlace(Made);
  for (const User *U : Made->users()) {
    const auto *Assign = dyn_cast<CallBase>(U);
    const Function *F = Assign ? Assign->getCalledFunction() : nullptr;
    if (!F || Assign->arg_size() != 2 || Assign->getArgOperand(1) != Made ||
        !givesValue(*F))
      continue;
    const Value *To = Assign->getArgOperand(0);
    if (To->getType()->isPointerTy())
      AddPlace(To);
  }
  Objects.push_back(std::move(O));
}

const Value *objectBehind(const Value *Object, const RuleMatches &Rules) {
  while (const auto *Outer = dyn_cast_or_null<CallBase>(Object)) {
    const Rule *Row = Rules.match(*Outer);
    if (!Row || Row->Kind != Rule::Accessor)
      break;
    Object = objectOf(*Outer, *Row);
  }
  return Object;
}

/// True if the address of \p Local, a local object, is stored, such as in
/// a lambda that may assign to it.
static bool isKept(const Value &Local) {
  return any_of(Local.users(), [&](const User *U) {
    const auto *Store = dyn_cast<StoreInst>(U);
    return Store && Store->getValueOperand() == &Local;
  });
}

bool leavesUnchanged(const CallBase &Call, const Function &Callee,
                     const Value *Object) {
  if (Callee.getName().starts_with("_ZNK") && Call.getArgOperand(0) == Object)
    return true;
  if (StringRef(qualifiedName(Callee.getName())).contains("::~"))
    return true;
  const SmallBitVector Const = constArguments(Callee);
  for (const auto &[N, Argument] : enumerate(Call.args()))
    if (Argument.get() == Object && (N >= Const.size() || !Const[N]))
      return false;
  return true;
}

/// An object may be a copy of a copy.
static constexpr unsigned MaxDepth = 4;

/// What \p Call says about the object that \p Local has before it, with those
/// reads added to \p Found: true if the search on this way has ended; none if
/// nothing is known.
std::optional<bool> MadeObjects::ends(const CallBase &Call, const Value *Local,
                                      unsigned Depth,
                                      SmallSetVector<unsigned, 2> &Found) {
  if (isa<IntrinsicInst>(Call) ||
      none_of(Call.args(), [&](const Use &U) { return U.get() == Local; }))
    return false;
  for (const MadeObject &O : Objects)
    if (Reads[O.Read].Call == &Call && O.Made == Local) {
      Found.insert(O.Read);
      return true;
    }
  const Function *Callee = Call.getCalledFunction();
  if (!Callee)
    return std::nullopt;
  if (Call.hasStructRetAttr() && Call.getArgOperand(0) == Local)
    return addReturned(*Callee, Found) ? std::optional(true) : std::nullopt;
  if (leavesUnchanged(Call, *Callee, Local))
    return false;
  if (Call.getArgOperand(0) != Local || !givesValue(*Callee))
    return std::nullopt;
  if (Call.arg_size() == 1)
    return true; // A new object, without a value.
  const Value *Source = objectBehind(Call.getArgOperand(1), Rules);
  if (!Source)
    return std::nullopt;
  Numbers From = lastAssigned(Source, Call, Depth + 1);
  // An element of a list is no local.
  SmallVector<unsigned, 2> Listed;
  if (!From && !isa<AllocaInst>(Source))
    Listed = storedAt(Source);
  if (!From && Listed.empty())
    return std::nullopt;
  if (From)
    Found.insert(From->begin(), From->end());
  Found.insert(Listed.begin(), Listed.end());
  return true;
}

/// The reads that gave \p Local, a local object, the value that it has at
/// \p At.
MadeObjects::Numbers MadeObjects::lastAssigned(const Value *Local,
                                               const Instruction &At,
                                               unsigned Depth) {
  constexpr unsigned MaxBlocks = 500;
  if (!isa<AllocaInst>(Local) || Depth == MaxDepth || isKept(*Local))
    return std::nullopt;
  SmallSetVector<unsigned, 2> Found;
  SmallPtrSet<const BasicBlock *, 16> Seen;
  SmallVector<const Instruction *, 8> Work;
  auto GoAbove = [&](const BasicBlock &BB) {
    for (const BasicBlock *Pred : predecessors(&BB))
      if (Seen.insert(Pred).second)
        Work.push_back(&Pred->back());
    return !pred_empty(&BB) && Seen.size() <= MaxBlocks;
  };
  if (const Instruction *Above = At.getPrevNode())
    Work.push_back(Above);
  else if (!GoAbove(*At.getParent()))
    return std::nullopt;
  while (!Work.empty()) {
    const Instruction *I = Work.pop_back_val();
    const BasicBlock *BB = I->getParent();
    std::optional<bool> Ended = false;
    for (; I && !*Ended; I = I->getPrevNode())
      if (const auto *Call = dyn_cast<CallBase>(I))
        if (Ended = ends(*Call, Local, Depth, Found); !Ended)
          return std::nullopt;
    if (!*Ended && !GoAbove(*BB))
      return std::nullopt;
  }
  return Found.empty() ? std::nullopt : Numbers(std::move(Found));
}

/// Adds the reads that make the object that \p F returns; false if there are
/// none.
bool MadeObjects::addReturned(const Function &F,
                              SmallSetVector<unsigned, 2> &Out) const {
  bool IsFound = false;
  for (const MadeObject &O : Objects)
    if (const auto *Result = dyn_cast<Argument>(O.Made);
        Result && Result->getParent() == &F && Result->hasStructRetAttr()) {
      Out.insert(O.Read);
      IsFound = true;
    }
  return IsFound;
}

/// The reads whose objects are stored where \p Object is.
SmallVector<unsigned, 2> MadeObjects::storedAt(const Value *Object) {
  SmallVector<unsigned, 2> Found;
  Locations Where = Pointers.resolve(Object, false);
  std::optional<unsigned> Index = indexOf(Object);
  for (const MadeObject &O : Objects) {
    if (Index && Reads[O.Read].Index && Index != Reads[O.Read].Index)
      continue;
    if (O.Pointers.contains(Object) || any_of(Where, [&](const auto &L) {
          return any_of(O.Where, [&](const auto &P) { return L.mayBe(P); });
        }))
      Found.push_back(O.Read);
  }
  return Found;
}

SmallVector<unsigned, 2> MadeObjects::readsOf(const Value *Object,
                                              const Instruction &At) {
  if (Numbers Last = lastAssigned(Object, At))
    return SmallVector<unsigned, 2>(Last->begin(), Last->end());
  return storedAt(Object);
}

} // namespace tpc
