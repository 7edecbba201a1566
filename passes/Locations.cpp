//===- Locations.cpp - What pointers and paths mean -----------------------===//
#include "ClassObjectAccess.h"

#include "Names.h"

#include "llvm/IR/Instructions.h"
#include "llvm/IR/Module.h"
#include "llvm/IR/Operator.h"

using namespace llvm;

namespace tpc {

/// Classes in classes that are entered. Real ones end long before; classes that
/// are taken for the same because they look alike may contain each other.
static constexpr unsigned MaxPath = 32;

//===----------------------------------------------------------------------===//
// Classes and locations
//===----------------------------------------------------------------------===//

/// True where \p A and \p B have the same fields, and these the same ones
/// again: instances of one class template have its name, whatever they are made
/// of.
static bool looksAlike(const StructType &A, const StructType &B) {
  ArrayRef<Type *> Mine = A.elements(), Theirs = B.elements();
  // As a base class, a class is there without the padding at its end.
  if (A.hasName() && B.hasName() &&
      A.getName().contains(".base") != B.getName().contains(".base")) {
    size_t Common = std::min(Mine.size(), Theirs.size());
    Mine = Mine.take_front(Common);
    Theirs = Theirs.take_front(Common);
  }
  return Mine.size() == Theirs.size() && all_of(zip(Mine, Theirs), [](auto P) {
           auto [One, Other] = P;
           const auto *S = dyn_cast<StructType>(One),
                      *T = dyn_cast<StructType>(Other);
           return One == Other || (S && T && looksAlike(*S, *T));
         });
}

unsigned TypeNumbers::numberOf(StructType *T) {
  if (auto It = Numbers.find(T); It != Numbers.end())
    return It->second;
  // Lambdas and classes of unnamed namespaces have their names to themselves.
  // Without a name, nothing says that two are the same.
  if (!T->hasName()) {
    Types.push_back(T);
    return Numbers[T] = Types.size() - 1;
  }
  StringRef Name = plainClassName(*T);
  if (Name == "anon" || Name.contains("(anonymous"))
    Name = T->getName();
  SmallVector<unsigned, 1> &Alike = ByName[Name];
  for (unsigned N : Alike)
    if (looksAlike(*T, *Types[N]))
      return Numbers[T] = N;
  unsigned N = Types.size();
  Types.push_back(T);
  Alike.push_back(N);
  return Numbers[T] = N;
}

bool TypeNumbers::isStandard(unsigned Number) const {
  return Number < Types.size() &&
         plainClassName(*Types[Number]).starts_with("std::");
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
  if (!L.Path.empty()) {
    const Step &Last = L.Path.back();
    if (!Last.isField())
      return nullptr;
    const StructType *Class = Numbers.typeOf(Last.Type);
    return Last.Index < Class->getNumElements()
               ? Class->getElementType(Last.Index)
               : nullptr;
  }
  if (const auto *Global = dyn_cast_or_null<GlobalVariable>(L.Root))
    return Global->getValueType();
  if (const auto *Local = dyn_cast_or_null<AllocaInst>(L.Root))
    return Local->getAllocatedType();
  return nullptr;
}

Type *elementOf(Type *T) {
  while (auto *Array = dyn_cast_or_null<ArrayType>(T))
    T = Array->getElementType();
  return T;
}

/// The source's type of what is at \p L; null where it is not known.
const DIType *AccessResult::debugTypeAt(const Location &L) const {
  if (L.Path.empty())
    return L.Root ? Debug->pointee(L.Root) : nullptr;
  const Step &Last = L.Path.back();
  if (!Last.isField())
    return nullptr;
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
    if (T->isOpaque() || T->getNumElements() == 0 || L.Path.size() >= MaxPath)
      return;
    enterField(L, T, 0);
  }
}

/// Adds the scalars of an object of type \p T at \p L, which begins \p At bytes
/// behind the beginning of an access, as far as the \p Size bytes of that go.
void AccessResult::addParts(const Location &L, Type *T, int64_t At,
                            uint64_t Size,
                            SmallVectorImpl<ScalarPart> &Out) const {
  T = elementOf(T);
  if (!T->isSized() || At >= static_cast<int64_t>(Size) ||
      Out.size() >= MaxLocations)
    return;
  auto *Class = dyn_cast<StructType>(T);
  if (Class && Class->getNumElements() && L.Path.size() < MaxPath) {
    const StructLayout *Fields = Layout->getStructLayout(Class);
    for (unsigned Field = 0; Field < Class->getNumElements(); ++Field) {
      Location Inner = L;
      enterField(Inner, Class, Field);
      addParts(Inner, Class->getElementType(Field),
               At + static_cast<int64_t>(Fields->getElementOffset(Field)), Size,
               Out);
    }
  } else if (At >= 0 && L.isKnown()) {
    Out.push_back({L, static_cast<unsigned>(At * 8),
                   static_cast<unsigned>(
                       Layout->getTypeStoreSizeInBits(T).getFixedValue())});
  }
}

/// The same for an access that begins with the scalar at \p L: the scalars that
/// follow it are in one of the objects that it is in. False where it is no more
/// than that scalar.
bool AccessResult::addPartsAround(Location L, uint64_t Size,
                                  SmallVectorImpl<ScalarPart> &Out) const {
  Type *T = elementOf(typeAt(L));
  if (!T || !T->isSized() ||
      Layout->getTypeStoreSize(T).getFixedValue() >= Size)
    return false;
  uint64_t At = 0;
  while (!L.Path.empty() && L.Path.back().isField()) {
    Step Last = L.Path.pop_back_val();
    StructType *Class = Numbers.typeOf(Last.Type);
    const StructLayout *Fields = Layout->getStructLayout(Class);
    At += Fields->getElementOffset(Last.Index);
    bool IsOutermost = L.Path.empty() || !L.Path.back().isField();
    if (!IsOutermost && At + Size > Fields->getSizeInBytes())
      continue;
    for (unsigned Field = Last.Index; Field < Class->getNumElements();
         ++Field) {
      Location Inner = L;
      Inner.Path.push_back({Last.Type, Field, Last.Class});
      addParts(Inner, Class->getElementType(Field),
               static_cast<int64_t>(Fields->getElementOffset(Field)) -
                   static_cast<int64_t>(At),
               Size, Out);
    }
    return true;
  }
  return false;
}

SmallVector<ScalarPart, 1> AccessResult::partsOf(const Instruction &I) const {
  Type *T = getLoadStoreType(const_cast<Instruction *>(&I));
  SmallVector<ScalarPart, 1> Parts;
  for (Location &L : resolve(getLoadStorePointerOperand(&I), true))
    if (!(T->isAggregateType() || T->isIntegerTy() || T->isVectorTy()) ||
        !addPartsAround(L, Layout->getTypeStoreSize(T).getKnownMinValue(),
                        Parts))
      Parts.push_back({std::move(L)});
  return Parts;
}

Locations AccessResult::touched(const Instruction &I) const {
  Locations All;
  for (ScalarPart &Part : partsOf(I))
    addTo(All, std::move(Part.Where));
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

/// Goes \p Steps further from \p L. How a container keeps its elements, in
/// nodes or in pairs with a key, makes no difference: those steps are left out.
void AccessResult::extend(Location &L, ArrayRef<Step> Steps) const {
  if (L.isElement())
    Steps = Steps.drop_while(
        [&](const Step &S) { return Numbers.isStandard(S.Type); });
  L.Path.append(Steps.begin(), Steps.end());
}

/// True for the calls that allocate memory.
static bool isAllocation(const Value *V) {
  const auto *Call = dyn_cast<CallBase>(V);
  const Function *Callee = Call ? Call->getCalledFunction() : nullptr;
  static constexpr StringRef Names[] = {
      "_Znwm",  "_Znam", "_ZnwmSt11align_val_t", "_ZnamSt11align_val_t",
      "malloc", "calloc"};
  return Callee && is_contained(Names, Callee->getName());
}

/// Adds the place that \p Chain leads to in the allocation at \p L: its type is
/// not known, but how far it is.
void AccessResult::addAllocated(const Location &L,
                                ArrayRef<const GEPOperator *> Chain,
                                Locations &Out) const {
  int64_t Bytes = L.Path.empty() ? 0 : L.Path.back().Index;
  for (const GEPOperator *GEP : Chain) {
    APInt Offset(Layout->getIndexTypeSizeInBits(GEP->getType()), 0);
    if (!GEP->accumulateConstantOffset(*Layout, Offset))
      return;
    Bytes += Offset.getSExtValue();
  }
  if (Bytes < 0)
    return;
  Location Here{L.Root, {}};
  if (Bytes)
    Here.Path.push_back({Step::Bytes, static_cast<unsigned>(Bytes)});
  addTo(Out, std::move(Here));
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

/// The pointer that \p Pointer is computed from.
const Value *AccessResult::baseOf(const Value *Pointer) {
  const Value *Base = throughCasts(Pointer);
  while (const auto *GEP = dyn_cast<GEPOperator>(Base))
    Base = throughCasts(GEP->getPointerOperand());
  return Base;
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
  if (Rooted || isAllocation(Base))
    Objects.push_back({Base, {}});
  else if (auto It = Targets.find(Base); It != Targets.end())
    Objects = It->second;
  // Besides the objects that are known there are those that are not: of them
  // the path alone is known, from its first class on.
  if (!Rooted && !Complete.contains(Base))
    Objects.insert(Objects.begin(), Location());
  for (Location L : Objects) {
    if (L.Root && isa<CallBase>(L.Root) &&
        (L.Path.empty() || L.Path.back().Type == Step::Bytes)) {
      // Where the way says which class it is, all objects of it are meant.
      if (none_of(Chain, [](const GEPOperator *GEP) {
            const auto *S = dyn_cast<StructType>(GEP->getSourceElementType());
            return S && !S->isLiteral();
          }))
        addAllocated(L, Chain, Out);
      continue;
    }
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
      if (L.isElement()) {
        Bytes = 0;
        Valid = true;
        extend(L, stepsOf(*GEP, Numbers, *Debug));
        continue;
      }
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
    if (Bytes == 0 || L.isElement() || descend(L, Bytes, nullptr))
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

} // namespace tpc
