//===- KeptObjects.cpp ----------------------------------------------------===//
#include "slice/KeptObjects.h"

#include "calls/ClassHierarchy.h"
#include "memory/PointsTo.h"
#include "support/Functions.h"
#include "support/Names.h"

#include "llvm/ADT/SmallPtrSet.h"
#include "llvm/IR/InstIterator.h"
#include "llvm/IR/IntrinsicInst.h"
#include "llvm/IR/Operator.h"

using namespace llvm;

namespace tpc {

namespace {

class KeptObjectFinder {
public:
  KeptObjectFinder(Module &M, const CallGraphResult &Calls,
                   const RuleMatches &Rules, DebugTypes &Debug,
                   const OverridingFunctions &Overriding, UserSources Sources)
      : M(M), Calls(Calls), Rules(Rules), Debug(Debug),
        Sources(std::move(Sources)) {
    StringSet<> Derived;
    for (const Function *F : Overriding.Functions) {
      Derived.insert(scopeOf(*F));
      addArguments(*F);
    }
    if (!Work.empty())
      for (Function &F : definedFunctions(M))
        if (Derived.contains(scopeOf(F)))
          Methods.insert(&F);
  }

  SmallVector<InheritedWrite, 0> find();

private:
  /// The member of a class with overriding functions, by the class and the
  /// number of the outermost field.
  using Member = std::pair<StructType *, uint64_t>;

  void addArguments(const Function &F);
  void add(const Value *Pointer, const Value *From);
  bool isPart(const DIType *T) const;
  std::optional<Member> memberAt(const Value *Pointer);
  void followUse(const Value &Pointer, const Use &U);
  void followCall(const Value &Pointer, const CallBase &Call, const Use &Arg);
  void addLoadsOfMembers();
  bool isWrite(const Instruction &I, const Value *&Pointer) const;

  Module &M;
  const CallGraphResult &Calls;
  const RuleMatches &Rules;
  DebugTypes &Debug;
  UserSources Sources;
  /// Of the classes with overriding functions.
  SmallSetVector<const Function *, 16> Methods;
  /// Pointers to what was handed over, to its parts, and to smart pointers that
  /// were handed over, each with the class of the object.
  MapVector<const Value *, const DICompositeType *> Handed;
  /// Those that were read from a member: what is written through them is not
  /// seen by looking at the arguments of a function.
  SmallPtrSet<const Value *, 16> Kept;
  DenseSet<Member> Members;
  SmallVector<const Value *, 16> Work; ///< pointers whose uses are to be seen
};

} // namespace

/// True if an object of type \p T is a part of the robot that others see, not a
/// tool that every class gets.
bool KeptObjectFinder::isPart(const DIType *T) const {
  const auto *Class = dyn_cast_or_null<DICompositeType>(T);
  if (!Class)
    return false;
  if (isSmartPointer(Class))
    return isPart(DebugTypes::plain(firstArgumentOf(*Class)));
  std::string Mangled = DebugTypes::identifierOf(*Class);
  return !isMessageClass(*Class) && StringRef(Mangled).starts_with("_ZTS") &&
         !Rules.isTool(className(StringRef(Mangled).drop_front(4)));
}

/// Adds the arguments of \p F, an overriding function, through which objects
/// are handed over that it may change.
void KeptObjectFinder::addArguments(const Function &F) {
  SmallVector<const Argument *, 4> Written = writtenArguments(F);
  for (const Argument &Arg : F.args()) {
    if (!Arg.getType()->isPointerTy() || Arg.hasStructRetAttr())
      continue;
    const DIType *T = Debug.pointee(&Arg);
    if ((is_contained(Written, &Arg) || isSmartPointer(T)) && isPart(T))
      add(&Arg, &Arg);
  }
}

/// Adds \p Pointer, which was made from \p From.
void KeptObjectFinder::add(const Value *Pointer, const Value *From) {
  const DIType *T = Debug.pointee(Pointer);
  const auto *Class = isPart(T) && !isSmartPointer(T) ? cast<DICompositeType>(T)
                                                      : Handed.lookup(From);
  bool IsNew = Handed.insert({Pointer, Class}).second;
  if (Kept.contains(From))
    IsNew |= Kept.insert(Pointer).second;
  if (IsNew)
    Work.push_back(Pointer);
}

/// The member of an object of a class with overriding functions that
/// \p Pointer, or an object that it lies in, is; none for other places.
std::optional<KeptObjectFinder::Member>
KeptObjectFinder::memberAt(const Value *Pointer) {
  const GEPOperator *Outermost = nullptr;
  while (const auto *GEP = dyn_cast<GEPOperator>(Pointer)) {
    if (GEP->getSourceElementType()->isStructTy() && GEP->getNumIndices() > 1)
      Outermost = GEP;
    Pointer = GEP->getPointerOperand();
  }
  const auto *This = dyn_cast<Argument>(Pointer);
  if (!This || !Outermost || thisOf(*This->getParent()) != This ||
      !Methods.contains(This->getParent()))
    return std::nullopt;
  const auto *Index = dyn_cast<ConstantInt>(Outermost->getOperand(2));
  if (!Index)
    return std::nullopt;
  return Member{cast<StructType>(Outermost->getSourceElementType()),
                Index->getZExtValue()};
}

/// \p Call gets \p Pointer, which leads to a part of what was handed over, as
/// \p Arg.
void KeptObjectFinder::followCall(const Value &Pointer, const CallBase &Call,
                                  const Use &Arg) {
  unsigned N = Call.getArgOperandNo(&Arg);
  for (const Function *Callee : Calls.callees(Call))
    if (N < Callee->arg_size() && Sources.has(*Callee))
      add(Callee->getArg(N), &Pointer);
  // What a method of the object returns.
  if (N == 0 && Call.getType()->isPointerTy() &&
      isPart(Debug.pointee(&Pointer)))
    add(&Call, &Pointer);
}

void KeptObjectFinder::followUse(const Value &Pointer, const Use &U) {
  const auto *I = cast<Instruction>(U.getUser());
  if (const auto *Store = dyn_cast<StoreInst>(I)) {
    if (Store->getValueOperand() == &Pointer)
      if (std::optional<Member> In = memberAt(Store->getPointerOperand()))
        Members.insert(*In);
    return;
  }
  if (const auto *Call = dyn_cast<CallBase>(I)) {
    if (Call->isArgOperand(&U) && !isa<IntrinsicInst>(Call))
      followCall(Pointer, *Call, U);
    return;
  }
  if (!I->getType()->isPointerTy() || !isa<GetElementPtrInst, CastInst, PHINode,
                                           SelectInst, FreezeInst, LoadInst>(I))
    return;
  add(I, &Pointer);
}

/// Adds what the methods read from the members.
void KeptObjectFinder::addLoadsOfMembers() {
  for (const Function *F : Methods)
    for (const Instruction &I : instructions(F)) {
      const auto *Load = dyn_cast<LoadInst>(&I);
      if (!Load || !Load->getType()->isPointerTy())
        continue;
      std::optional<Member> From = memberAt(Load->getPointerOperand());
      if (From && Members.contains(*From)) {
        if (Kept.insert(Load).second)
          Work.push_back(Load);
        add(Load, Load);
      }
    }
}

/// True if \p I writes into a kept object; sets \p Pointer to where.
bool KeptObjectFinder::isWrite(const Instruction &I,
                               const Value *&Pointer) const {
  if (const auto *Store = dyn_cast<StoreInst>(&I)) {
    Pointer = Store->getPointerOperand();
    return Kept.contains(Pointer);
  }
  if (const auto *Set = dyn_cast<MemIntrinsic>(&I)) {
    Pointer = Set->getRawDest();
    return Kept.contains(Pointer);
  }
  const auto *Call = dyn_cast<CallBase>(&I);
  const Function *Callee = Call ? Call->getCalledFunction() : nullptr;
  Pointer = Call ? containerOf(*Call) : nullptr;
  if (!Pointer || Call->getType()->isPointerTy() || !Kept.contains(Pointer) ||
      !isPart(Debug.pointee(Pointer)))
    return false;
  // What returns a value and takes nothing only asks, even if it is not const.
  bool Returns = Call->hasStructRetAttr() || !Call->getType()->isVoidTy();
  if (Returns && Call->arg_size() == (Call->hasStructRetAttr() ? 2 : 1))
    return false;
  if (!Callee)
    return ClassHierarchy::match(*Call) && Calls.callees(*Call).empty();
  StringRef Name = Callee->getName();
  // A method has its object before what it is written with.
  return Callee->isDeclarationForLinker() && !endsLife(*Call) &&
         Name.starts_with("_ZN") && !Name.starts_with("_ZNK") &&
         Call->arg_size() > parameterTypes(*Callee).size();
}

SmallVector<InheritedWrite, 0> KeptObjectFinder::find() {
  SmallVector<InheritedWrite, 0> Found;
  size_t Known = 0;
  do {
    while (!Work.empty()) {
      const Value *Pointer = Work.pop_back_val();
      for (const Use &U : Pointer->uses())
        if (isa<Instruction>(U.getUser()))
          followUse(*Pointer, U);
    }
    if (Members.size() > Known) {
      Known = Members.size();
      addLoadsOfMembers();
    }
  } while (!Work.empty());
  if (Kept.empty())
    return Found;
  for (Function &F : definedFunctions(M))
    for (Instruction &I : instructions(F)) {
      const Value *Pointer = nullptr;
      if (!isWrite(I, Pointer))
        continue;
      const DICompositeType *Class = Handed.lookup(Pointer);
      Found.push_back({&I, Class ? Class->getName().str() : "object"});
    }
  return Found;
}

SmallVector<InheritedWrite, 0>
keptObjectWrites(Module &M, const CallGraphResult &Calls,
                 const RuleMatches &Rules, DebugTypes &Debug,
                 const OverridingFunctions &Overriding, UserSources Sources) {
  return KeptObjectFinder(M, Calls, Rules, Debug, Overriding,
                          std::move(Sources))
      .find();
}

} // namespace tpc
