//===- ClassObjectAccess.cpp ----------------------------------------------===//
#include "ClassObjectAccess.h"

#include "Functions.h"
#include "Names.h"
#include "Print.h"
#include "Rules.h"

#include "llvm/ADT/SmallPtrSet.h"
#include "llvm/Analysis/ValueTracking.h"
#include "llvm/IR/InstIterator.h"
#include "llvm/IR/IntrinsicInst.h"
#include "llvm/IR/Module.h"
#include "llvm/IR/Operator.h"

using namespace llvm;

namespace tpc {

AnalysisKey ClassObjectAccess::Key;

/// More places than this for one pointer say nothing any more.
static constexpr unsigned MaxLocations = 64;
/// Variables that a value is followed to by copies of whole objects.
static constexpr unsigned MaxCopied = 16;

//===----------------------------------------------------------------------===//
// Classes and locations
//===----------------------------------------------------------------------===//

unsigned TypeNumbers::numberOf(StructType *T) {
  if (auto It = Numbers.find(T); It != Numbers.end())
    return It->second;
  // Lambdas and classes of unnamed namespaces have their names to themselves.
  StringRef Name = plainClassName(*T);
  if (Name == "anon" || Name.contains("(anonymous"))
    Name = T->getName();
  SmallVector<unsigned, 1> &Alike = ByName[Name];
  for (unsigned N : Alike) {
    ArrayRef<Type *> Mine = T->elements(), Theirs = Types[N]->elements();
    // As a base class, a class is there without the padding at its end.
    if (T->hasName() && T->getName().contains(".base") !=
                            Types[N]->getName().contains(".base")) {
      size_t Common = std::min(Mine.size(), Theirs.size());
      Mine = Mine.take_front(Common);
      Theirs = Theirs.take_front(Common);
    }
    if (Mine.size() == Theirs.size() &&
        all_of(zip(Mine, Theirs), [](auto Pair) {
          auto [A, B] = Pair;
          return A == B || (A->isStructTy() && B->isStructTy());
        }))
      return Numbers[T] = N;
  }
  unsigned N = Types.size();
  Types.push_back(T);
  Alike.push_back(N);
  return Numbers[T] = N;
}

/// True where \p Tail is the end of \p Path.
static bool endsWith(ArrayRef<Step> Path, ArrayRef<Step> Tail) {
  return Tail.size() <= Path.size() && equal(Tail, Path.take_back(Tail.size()));
}

bool Location::mayBe(const Location &O) const {
  if (Root && O.Root)
    return *this == O;
  if (Path.empty() || O.Path.empty())
    return false;
  if (Root)
    return endsWith(Path, O.Path);
  if (O.Root)
    return endsWith(O.Path, Path);
  return endsWith(Path, O.Path) || endsWith(O.Path, Path);
}

/// Location::mayBe, with what is known of local variables: one that no other
/// function can reach is not what a pointer of theirs leads to.
bool AccessResult::mayBe(const Location &A, const Location &B) const {
  for (const auto &[Local, Other] : {std::pair(&A, &B), std::pair(&B, &A)})
    if (Local->Root && !Other->Root && isa<AllocaInst>(Local->Root) &&
        !Escaped.contains(Local->Root))
      return false;
  return A.mayBe(B);
}

Type *AccessResult::typeAt(const Location &L) const {
  if (!L.Path.empty())
    return Numbers.typeOf(L.Path.back().Type)
        ->getElementType(L.Path.back().Index);
  if (const auto *Global = dyn_cast_or_null<GlobalVariable>(L.Root))
    return Global->getValueType();
  if (const auto *Local = dyn_cast_or_null<AllocaInst>(L.Root))
    return Local->getAllocatedType();
  return nullptr;
}

static Type *elementOf(Type *T) {
  while (auto *Array = dyn_cast_or_null<ArrayType>(T))
    T = Array->getElementType();
  return T;
}

/// The source's type of what is at \p L; null where it is not known.
const DIType *AccessResult::debugTypeAt(const Location &L) const {
  if (L.Path.empty())
    return L.Root ? Debug->pointee(L.Root) : nullptr;
  const Step &Last = L.Path.back();
  return Debug->field(Debug->classOf(Last.Class), Numbers.typeOf(Last.Type),
                      Last.Index);
}

void AccessResult::enterField(Location &L, StructType *T,
                              unsigned Field) const {
  unsigned Class = Debug->numberOf(Debug->asStruct(debugTypeAt(L), T));
  L.Path.push_back({Numbers.numberOf(T), Field, Class});
}

void AccessResult::enterScalar(Location &L) const {
  while (auto *T = dyn_cast_or_null<StructType>(elementOf(typeAt(L)))) {
    if (T->isOpaque() || T->getNumElements() == 0)
      return;
    enterField(L, T, 0);
  }
}

void AccessResult::addScalarsOf(const Location &L, Locations &Out) const {
  auto *T = dyn_cast_or_null<StructType>(elementOf(typeAt(L)));
  if (!T || T->isOpaque() || T->getNumElements() == 0)
    return addTo(Out, L);
  for (unsigned Field = 0; Field < T->getNumElements(); ++Field) {
    Location Inner = L;
    enterField(Inner, T, Field);
    addScalarsOf(Inner, Out);
  }
}

Locations AccessResult::touched(const Instruction &I) const {
  const Value *Pointer = getLoadStorePointerOperand(&I);
  if (!getLoadStoreType(const_cast<Instruction *>(&I))->isAggregateType())
    return resolve(Pointer, true);
  Locations All;
  for (const Location &L : resolve(Pointer, false))
    addScalarsOf(L, All);
  return All;
}

bool AccessResult::contains(Type *Outer, unsigned Inner) const {
  auto *T = dyn_cast_or_null<StructType>(elementOf(Outer));
  if (!T || T->isOpaque())
    return false;
  return Numbers.numberOf(T) == Inner ||
         any_of(T->elements(),
                [&](Type *Field) { return contains(Field, Inner); });
}

/// The way from \p Object to \p L, where \p L can be \p Object or in it.
std::optional<SmallVector<Step, 4>>
AccessResult::partOf(const Location &Object, const Location &L) const {
  ArrayRef<Step> Path = L.Path;
  if (Object.Root && L.Root) {
    if (Object.Root != L.Root || Path.size() < Object.Path.size() ||
        !equal(Path.take_front(Object.Path.size()), Object.Path))
      return std::nullopt;
    return SmallVector<Step, 4>(Path.drop_front(Object.Path.size()));
  }
  for (size_t K = 1; K <= Path.size(); ++K) {
    Location Front{L.Root, SmallVector<Step, 4>(Path.take_front(K))};
    if (mayBe(Front, Object))
      return SmallVector<Step, 4>(Path.drop_front(K));
  }
  bool Reachable = !Object.Root || !isa<AllocaInst>(Object.Root) ||
                   Escaped.contains(Object.Root);
  if (Reachable && !L.Root && !Path.empty() &&
      contains(typeAt(Object), Path[0].Type))
    return SmallVector<Step, 4>(Path);
  return std::nullopt;
}

//===----------------------------------------------------------------------===//
// From a pointer to locations
//===----------------------------------------------------------------------===//

void AccessResult::addTo(Locations &Out, Location L) const {
  if (L.isKnown() && Out.size() < MaxLocations && !is_contained(Out, L))
    Out.push_back(std::move(L));
}

/// The steps of \p GEP's constant indices into classes.
static SmallVector<Step, 4> stepsOf(const GEPOperator &GEP,
                                    TypeNumbers &Numbers, DebugTypes &Debug) {
  SmallVector<Step, 4> Steps;
  Type *T = GEP.getSourceElementType();
  const DIType *Source = Debug.pointee(GEP.getPointerOperand());
  for (const Use &U : drop_begin(GEP.indices())) {
    if (auto *Struct = dyn_cast<StructType>(T)) {
      unsigned Field = cast<ConstantInt>(U.get())->getZExtValue();
      const DICompositeType *Class = Debug.asStruct(Source, Struct);
      Steps.push_back({Numbers.numberOf(Struct), Field, Debug.numberOf(Class)});
      Source = Debug.field(Class, Struct, Field);
      T = Struct->getElementType(Field);
    } else {
      T = GetElementPtrInst::getTypeAtIndex(T, U.get());
    }
  }
  return Steps;
}

/// Goes \p Offset bytes into \p L, and with \p Until no further than to an
/// object of that type; takes the way off \p Offset. False where nothing
/// begins there.
bool AccessResult::descend(Location &L, int64_t &Offset,
                           StructType *Until) const {
  Type *T = elementOf(typeAt(L));
  while (T && Offset >= 0) {
    auto *Class = dyn_cast<StructType>(T);
    if (Class && Until && Offset == 0 &&
        Numbers.numberOf(Class) == Numbers.numberOf(Until))
      return true;
    if (!Class || Class->isOpaque() || Class->getNumElements() == 0)
      break;
    const StructLayout *Fields = Layout->getStructLayout(Class);
    if (static_cast<uint64_t>(Offset) >= Fields->getSizeInBytes())
      return false;
    unsigned Field = Fields->getElementContainingOffset(Offset);
    enterField(L, Class, Field);
    Offset -= Fields->getElementOffset(Field);
    T = Class->getElementType(Field);
    if (T->isArrayTy()) {
      T = elementOf(T);
      Offset %= Layout->getTypeAllocSize(T).getFixedValue();
    }
  }
  return T && Offset == 0 && !Until;
}

/// What is between a pointer and the pointer that it is computed from.
static const Value *throughCasts(const Value *V) {
  while (true) {
    if (const auto *Cast = dyn_cast<CastInst>(V);
        Cast && Cast->getOperand(0)->getType()->isPointerTy())
      V = Cast->getOperand(0);
    else if (const auto *Freeze = dyn_cast<FreezeInst>(V))
      V = Freeze->getOperand(0);
    else
      return V;
  }
}

/// Adds the locations that \p Pointer can lead to, as far as it is known by
/// now what the pointers that it is computed from lead to.
void AccessResult::addPointees(const Value *Pointer, Locations &Out) const {
  SmallVector<const GEPOperator *, 4> Chain;
  const Value *Base = throughCasts(Pointer);
  while (const auto *GEP = dyn_cast<GEPOperator>(Base)) {
    if (!GEP->hasAllZeroIndices() || GEP->getNumIndices() > 1)
      Chain.push_back(GEP);
    Base = throughCasts(GEP->getPointerOperand());
  }
  Locations Objects;
  bool Rooted = isa<GlobalVariable>(Base) || isa<AllocaInst>(Base);
  if (Rooted)
    Objects.push_back({Base, {}});
  else if (auto It = Targets.find(Base); It != Targets.end())
    Objects = It->second;
  // Besides the objects that are known there are those that are not: of them
  // the path alone is known, from its first class on.
  if (!Rooted)
    Objects.insert(Objects.begin(), Location());
  for (Location L : Objects) {
    bool Unknown = !L.isKnown();
    int64_t Bytes = 0;
    bool Valid = true;
    for (const GEPOperator *GEP : reverse(Chain)) {
      auto *Struct = dyn_cast<StructType>(GEP->getSourceElementType());
      // By bytes, or by the shape that the calling convention gives an object
      // in registers: the way has to be found in the object itself.
      if ((Struct && Struct->isLiteral()) ||
          GEP->getSourceElementType()->isIntegerTy(8)) {
        APInt Offset(Layout->getIndexTypeSizeInBits(GEP->getType()), 0);
        Valid &= GEP->accumulateConstantOffset(*Layout, Offset);
        Bytes += Offset.getSExtValue();
        continue;
      }
      if (!Struct)
        continue;
      // A base class, or what a pointer of another type was made of.
      if (L.isKnown() && (Bytes != 0 || elementOf(typeAt(L)) != Struct)) {
        Location Inner = L;
        L = descend(Inner, Bytes, Struct) ? Inner : Location();
      }
      Bytes = 0;
      Valid = true;
      L.Path.append(stepsOf(*GEP, Numbers, *Debug));
    }
    if (!Valid || !L.isKnown() || (Unknown && Chain.empty()))
      continue;
    if (Bytes == 0 || descend(L, Bytes, nullptr))
      addTo(Out, std::move(L));
  }
}

Locations AccessResult::resolve(const Value *Pointer, bool Scalar) const {
  Locations Found;
  addPointees(Pointer, Found);
  if (!Scalar)
    return Found;
  Locations Entered;
  for (Location &L : Found) {
    enterScalar(L);
    addTo(Entered, std::move(L));
  }
  return Entered;
}

//===----------------------------------------------------------------------===//
// Accesses
//===----------------------------------------------------------------------===//

AccessResult::Slot AccessResult::slot(const Location &L) {
  if (L.Path.empty())
    return {L.Root, ~0U};
  return {reinterpret_cast<const void *>(
              static_cast<uintptr_t>(L.Path.back().Type) * 16 + 8),
          L.Path.back().Index};
}

void AccessResult::file(SmallVectorImpl<Access> &List, Index &In,
                        Instruction &I, const Location &L) {
  In[slot(L)].push_back(List.size());
  List.push_back({&I, L});
}

/// Calls \p F with the numbers that \p In has for \p L and for the objects
/// that its path leads through.
template <typename Fn>
void AccessResult::eachObject(const Location &L, const Index &In, Fn F) {
  auto Visit = [&](const Location &Object) {
    auto It = In.find(slot(Object));
    if (It != In.end())
      for (unsigned N : It->second)
        F(N);
  };
  if (L.Root)
    Visit({L.Root, {}});
  for (size_t K = 1; K <= L.Path.size(); ++K)
    Visit({L.Root, SmallVector<Step, 4>(ArrayRef(L.Path).take_front(K))});
}

/// The numbers of the classes that are in an object of type \p T.
static void classesIn(Type *T, TypeNumbers &Numbers,
                      SmallSetVector<unsigned, 8> &Out) {
  auto *Class = dyn_cast_or_null<StructType>(elementOf(T));
  if (!Class || Class->isOpaque() || !Out.insert(Numbers.numberOf(Class)))
    return;
  for (Type *Field : Class->elements())
    classesIn(Field, Numbers, Out);
}

void AccessResult::fileCopy(CopyIndex &In, unsigned N,
                            const Location &Object) const {
  In.BySlot[slot(Object)].push_back(N);
  SmallSetVector<unsigned, 8> Classes;
  classesIn(typeAt(Object), Numbers, Classes);
  for (unsigned Class : Classes)
    In.ByClass[Class].push_back(N);
}

/// \p L and the variables that copies of whole objects put its value into, or
/// with \p Backward took it from.
Locations AccessResult::throughCopies(const Location &L, bool Backward) const {
  Locations All{L};
  const CopyIndex &In = Backward ? CopiesTo : CopiesFrom;
  for (unsigned Next = 0; Next < All.size() && All.size() < MaxCopied; ++Next) {
    const Location Here = All[Next];
    auto Follow = [&](unsigned N) {
      const Copy &C = Copies[N];
      for (const Location &Object : Backward ? C.To : C.From)
        if (auto Rest = partOf(Object, Here))
          for (Location Other : Backward ? C.From : C.To) {
            Other.Path.append(Rest->begin(), Rest->end());
            if (All.size() < MaxCopied && !is_contained(All, Other))
              All.push_back(std::move(Other));
          }
    };
    eachObject(Here, In.BySlot, Follow);
    if (!Here.Root && !Here.Path.empty())
      if (auto It = In.ByClass.find(Here.Path[0].Type); It != In.ByClass.end())
        for_each(It->second, Follow);
  }
  return All;
}

void AccessResult::collectWrites(const Location &L,
                                 SmallSetVector<Instruction *, 8> &Out) const {
  for (const Location &Here : throughCopies(L, /*Backward=*/true)) {
    auto It = StoreIndex.find(slot(Here));
    if (It != StoreIndex.end())
      for (unsigned N : It->second)
        if (mayBe(Stores[N].Where, Here))
          Out.insert(Stores[N].I);
    eachObject(Here, HandedIndex, [&](unsigned N) {
      if (partOf(Handed[N].Where, Here))
        Out.insert(Handed[N].I);
    });
  }
}

void AccessResult::collectLoads(const Location &L,
                                SmallSetVector<LoadInst *, 8> &Out) const {
  for (const Location &Here : throughCopies(L, /*Backward=*/false)) {
    auto It = LoadIndex.find(slot(Here));
    if (It != LoadIndex.end())
      for (unsigned N : It->second)
        if (mayBe(Loads[N].Where, Here))
          Out.insert(cast<LoadInst>(Loads[N].I));
  }
}

/// True where \p Pointer is one place, not any element of an array.
static bool isOnePlace(const Value *Pointer) {
  while (const auto *GEP = dyn_cast<GEPOperator>(Pointer)) {
    if (!GEP->hasAllConstantIndices())
      return false;
    Pointer = GEP->getPointerOperand();
  }
  return isa<AllocaInst>(Pointer) &&
         !cast<AllocaInst>(Pointer)->getAllocatedType()->isArrayTy();
}

/// True where \p I is a call that is handed a pointer into \p Local.
static bool isHanded(const Instruction &I, const Value *Local) {
  const auto *Call = dyn_cast<CallBase>(&I);
  return Call && any_of(Call->args(), [&](const Use &U) {
           const Value *V = U.get();
           while (const auto *GEP = dyn_cast<GEPOperator>(V))
             V = GEP->getPointerOperand();
           return V == Local;
         });
}

/// Leaves in \p W the writes of the local variable \p L that reach \p Load:
/// walks the flow graph back from it and stops at stores that surely replace
/// the value. A write in another function happens at a call that is handed
/// the variable; where its address was stored away, all of them stay.
void AccessResult::reachingWrites(const LoadInst &Load, const Location &L,
                                  SmallSetVector<Instruction *, 8> &W) const {
  const auto *Local = cast<AllocaInst>(L.Root);
  for (const User *U : Local->users())
    if (const auto *Store = dyn_cast<StoreInst>(U);
        Store && Store->getValueOperand() == Local)
      return;
  SmallPtrSet<const Instruction *, 8> Reached;
  bool CallReached = false;
  SmallPtrSet<const BasicBlock *, 16> Seen;
  SmallVector<const BasicBlock *, 16> Work;
  // True where the walk goes on above this instruction.
  auto Step = [&](const Instruction &I) {
    if (W.contains(const_cast<Instruction *>(&I)))
      Reached.insert(&I);
    CallReached |= isHanded(I, Local);
    const auto *Store = dyn_cast<StoreInst>(&I);
    return !(Store && W.contains(const_cast<StoreInst *>(Store)) &&
             isOnePlace(Store->getPointerOperand()));
  };
  auto Above = [&](const BasicBlock *BB) {
    for (const BasicBlock *Pred : predecessors(BB))
      if (Seen.insert(Pred).second)
        Work.push_back(Pred);
  };
  const Instruction *I = Load.getPrevNode();
  while (I && Step(*I))
    I = I->getPrevNode();
  if (!I)
    Above(Load.getParent());
  while (!Work.empty()) {
    const BasicBlock *BB = Work.pop_back_val();
    bool Open = true;
    for (const Instruction &J : reverse(*BB))
      if (!(Open = Step(J)))
        break;
    if (Open)
      Above(BB);
  }
  W.remove_if([&](Instruction *Write) {
    return Write->getFunction() == Load.getFunction() ? !Reached.contains(Write)
                                                      : !CallReached;
  });
}

SmallVector<Instruction *, 8>
AccessResult::definitionsOf(const LoadInst &Load) const {
  SmallSetVector<Instruction *, 8> All;
  for (const Location &L : touched(Load)) {
    SmallSetVector<Instruction *, 8> Writes;
    collectWrites(L, Writes);
    if (const auto *Local = dyn_cast_or_null<AllocaInst>(L.Root);
        Local && Local->getFunction() == Load.getFunction())
      reachingWrites(Load, L, Writes);
    All.insert(Writes.begin(), Writes.end());
  }
  return All.takeVector();
}

SmallVector<Instruction *, 8> AccessResult::writesOf(const Location &L) const {
  SmallSetVector<Instruction *, 8> Out;
  collectWrites(L, Out);
  return Out.takeVector();
}

SmallVector<LoadInst *, 8> AccessResult::usesOf(const Instruction &Write,
                                                const Value *Pointer) const {
  SmallSetVector<LoadInst *, 8> All;
  for (const Location &L : resolve(Pointer, true))
    collectLoads(L, All);
  All.remove_if([&](LoadInst *Load) {
    return isa<AllocaInst>(getUnderlyingObject(Load->getPointerOperand())) &&
           !is_contained(definitionsOf(*Load), &Write);
  });
  return All.takeVector();
}

SmallVector<Instruction *, 8>
AccessResult::writesInto(const Location &L) const {
  SmallSetVector<Instruction *, 8> Out;
  for (const auto *List : {&Stores, &Handed, &Passed})
    for (const Access &A : *List)
      if (partOf(L, A.Where))
        Out.insert(A.I);
  for (const Copy &C : Copies)
    for (const Location &To : C.To)
      if (partOf(L, To))
        Out.insert(C.I);
  return Out.takeVector();
}

/// Fills an AccessResult.
struct AccessResult::Builder {
  AccessResult &R;
  const CallGraphResult &Calls;
  const RuleMatches &Rules;
  Module &M;

  /// The pointers that a node of the graph takes its targets from.
  struct Node {
    const Value *V;
    SmallVector<const Value *, 2> Sources;
  };
  SmallVector<Node, 0> Nodes;

  void findEscaped();
  void makeNodes();
  void returned(const CallBase &Call, Node &N) const;
  bool propagate();
  void fileStores();
  void fileRest();
};

/// Rounds until the pointers lead nowhere new; more than a chain of pointers
/// through memory that is as long is not followed.
static constexpr unsigned MaxRounds = 8;

/// A pointer that a function returned. Where it returns one of its arguments,
/// that of this very call is meant: std::max(a, b) is a or b.
void AccessResult::Builder::returned(const CallBase &Call, Node &N) const {
  for (const Function *Callee : Calls.callees(Call))
    for (const BasicBlock &BB : *Callee) {
      const auto *Return = dyn_cast<ReturnInst>(BB.getTerminator());
      if (!Return || !Return->getReturnValue())
        continue;
      SmallVector<const Value *, 4> Work{Return->getReturnValue()};
      SmallPtrSet<const Value *, 8> Seen;
      while (!Work.empty()) {
        const Value *V = Work.pop_back_val();
        if (!Seen.insert(V).second)
          continue;
        if (const auto *Phi = dyn_cast<PHINode>(V))
          append_range(Work, Phi->incoming_values());
        else if (const auto *Arg = dyn_cast<Argument>(V))
          N.Sources.push_back(Call.getArgOperand(Arg->getArgNo()));
        else
          N.Sources.push_back(V);
      }
    }
}

/// A local escapes where its address is stored or returned, or goes into a
/// function that is looked into.
void AccessResult::Builder::findEscaped() {
  for (Function &F : definedFunctions(M))
    for (Instruction &I : instructions(F)) {
      if (!isa<AllocaInst>(&I))
        continue;
      SmallVector<const Value *, 8> Work{&I};
      SmallPtrSet<const Value *, 8> Seen;
      while (!Work.empty()) {
        const Value *V = Work.pop_back_val();
        if (!Seen.insert(V).second)
          continue;
        for (const Use &U : V->uses()) {
          const auto *User = cast<Instruction>(U.getUser());
          const auto *Call = dyn_cast<CallBase>(User);
          if (isa<GEPOperator>(User) || isa<CastInst>(User))
            Work.push_back(User);
          else if (isa<PHINode>(User) || isa<SelectInst>(User) ||
                   isa<ReturnInst>(User) ||
                   (isa<StoreInst>(User) && U.getOperandNo() == 0) ||
                   (Call && !Calls.callees(*Call).empty()))
            R.Escaped.insert(&I);
        }
      }
    }
}

void AccessResult::Builder::makeNodes() {
  for (Function &F : definedFunctions(M)) {
    for (const Argument &Arg : F.args()) {
      if (!Arg.getType()->isPointerTy())
        continue;
      Node N{&Arg, {}};
      for (const CallBase *Call : Calls.callers(&F))
        if (Arg.getArgNo() < Call->arg_size())
          N.Sources.push_back(Call->getArgOperand(Arg.getArgNo()));
      Nodes.push_back(std::move(N));
    }
    for (Instruction &I : instructions(F)) {
      if (!I.getType()->isPointerTy())
        continue;
      Node N{&I, {}};
      if (const auto *Phi = dyn_cast<PHINode>(&I))
        append_range(N.Sources, Phi->incoming_values());
      else if (const auto *Select = dyn_cast<SelectInst>(&I))
        N.Sources = {Select->getTrueValue(), Select->getFalseValue()};
      else if (const auto *Call = dyn_cast<CallBase>(&I))
        returned(*Call, N);
      else if (!isa<LoadInst>(&I))
        continue;
      Nodes.push_back(std::move(N));
    }
  }
}

/// One round; true where something new was found.
bool AccessResult::Builder::propagate() {
  bool Changed = false;
  for (const Node &N : Nodes) {
    Locations Found = R.Targets.lookup(N.V);
    size_t Before = Found.size();
    for (const Value *Source : N.Sources)
      R.addPointees(Source, Found);
    if (const auto *Load = dyn_cast<LoadInst>(N.V))
      for (const Location &L : R.resolve(Load->getPointerOperand(), true))
        if (auto It = R.StoreIndex.find(slot(L)); It != R.StoreIndex.end())
          for (unsigned S : It->second)
            if (R.mayBe(R.Stores[S].Where, L))
              R.addPointees(cast<StoreInst>(R.Stores[S].I)->getValueOperand(),
                            Found);
    if (Found.size() == Before)
      continue;
    Changed = true;
    R.Targets[N.V] = std::move(Found);
  }
  return Changed;
}

void AccessResult::Builder::fileStores() {
  R.Stores.clear();
  R.StoreIndex.clear();
  for (Function &F : definedFunctions(M)) {
    if (Rules.isOpaque(F))
      continue;
    for (Instruction &I : instructions(F))
      if (auto *Store = dyn_cast<StoreInst>(&I))
        for (const Location &L : R.touched(*Store))
          R.file(R.Stores, R.StoreIndex, I, L);
  }
}

void AccessResult::Builder::fileRest() {
  for (Function &F : definedFunctions(M)) {
    if (Rules.isOpaque(F))
      continue;
    for (Instruction &I : instructions(F)) {
      if (auto *Load = dyn_cast<LoadInst>(&I)) {
        for (const Location &L : R.touched(*Load))
          R.file(R.Loads, R.LoadIndex, I, L);
      } else if (auto *Copy = dyn_cast<MemTransferInst>(&I)) {
        Locations To = R.resolve(Copy->getRawDest(), false);
        Locations From = R.resolve(Copy->getRawSource(), false);
        for (const Location &L : To)
          R.fileCopy(R.CopiesTo, R.Copies.size(), L);
        for (const Location &L : From)
          R.fileCopy(R.CopiesFrom, R.Copies.size(), L);
        R.Copies.push_back({&I, std::move(To), std::move(From)});
      } else if (auto *Call = dyn_cast<CallBase>(&I);
                 Call && !isa<IntrinsicInst>(Call)) {
        bool Opaque = Calls.callees(*Call).empty();
        for (const auto &[N, Arg] : enumerate(Call->args()))
          if (Arg->getType()->isPointerTy() && !Call->onlyReadsMemory(N))
            for (const Location &L : R.resolve(Arg, false))
              R.file(Opaque ? R.Handed : R.Passed,
                     Opaque ? R.HandedIndex : R.PassedIndex, I, L);
      }
    }
  }
}

AccessResult ClassObjectAccess::run(Module &M, ModuleAnalysisManager &AM) {
  AccessResult R;
  R.Layout = &M.getDataLayout();
  R.Debug = std::make_unique<DebugTypes>(*R.Layout);
  AccessResult::Builder B{R,
                          AM.getResult<SimpleCallGraph>(M),
                          AM.getResult<RuleAnalysis>(M),
                          M,
                          {}};
  B.findEscaped();
  B.makeNodes();
  bool Changed = true;
  for (unsigned Round = 0; Round < MaxRounds && Changed; ++Round) {
    Changed = B.propagate();
    B.fileStores();
  }
  B.fileRest();
  return R;
}

PreservedAnalyses ClassObjectAccessPrinter::run(Module &M,
                                                ModuleAnalysisManager &AM) {
  const AccessResult &R = AM.getResult<ClassObjectAccess>(M);
  OS << "accesses of " << M.getName() << '\n';
  auto Print = [&](const char *What, ArrayRef<Access> List) {
    for (const Access &A : List) {
      OS << "  " << What << ' ';
      if (A.Where.Root)
        A.Where.Root->printAsOperand(OS, false);
      for (const Step &S : A.Where.Path) {
        const StructType *T = R.types().typeOf(S.Type);
        OS << '[' << (T->hasName() ? T->getName() : "literal") << '.' << S.Index
           << ']';
      }
      OS << " in " << A.I->getFunction()->getName() << place(*A.I) << '\n';
    }
  };
  Print("load", R.loads());
  Print("store", R.stores());
  return PreservedAnalyses::all();
}

} // namespace tpc
