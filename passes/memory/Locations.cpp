//===- Locations.cpp - What paths mean ------------------------------------===//
#include "memory/ClassObjectAccess.h"

#include "support/Names.h"

#include "llvm/IR/Instructions.h"
#include "llvm/IR/Module.h"

using namespace llvm;

namespace tpc {

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

void AccessResult::findClassesOfGlobals(const Module &M) {
  // All types of a module are not at hand; few modules need them.
  std::optional<std::vector<StructType *>> All;
  for (const GlobalVariable &Global : M.globals()) {
    const auto *T = dyn_cast<StructType>(Global.getValueType());
    if (!T || !T->isLiteral() || !Debug->pointee(&Global))
      continue;
    if (!All)
      All = M.getIdentifiedStructTypes();
    if (StructType *Class = Debug->classOf(Global, *All))
      ClassOfGlobal[&Global] = Class;
  }
}

/// The type that the variable at \p L was declared with, also where \p L is one
/// element of it.
Type *AccessResult::declaredTypeAt(const Location &L) const {
  if (!L.Path.empty()) {
    const Step &Last = L.Path.back();
    if (!Last.isField())
      return nullptr;
    const StructType *Class = Numbers.typeOf(Last.Type);
    return Last.Index < Class->getNumElements()
               ? Class->getElementType(Last.Index)
               : nullptr;
  }
  if (const auto *Global = dyn_cast_or_null<GlobalVariable>(L.Root)) {
    StructType *Class = ClassOfGlobal.lookup(Global);
    return Class ? Class : Global->getValueType();
  }
  if (const auto *Local = dyn_cast_or_null<AllocaInst>(L.Root))
    return Local->getAllocatedType();
  return nullptr;
}

Type *AccessResult::typeAt(const Location &L) const {
  Type *T = declaredTypeAt(L);
  return L.item().Number == Nth::Whole ? T : elementOf(T);
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

/// Of an array the element at its beginning.
void AccessResult::enterElement(Location &L) const {
  if (isa_and_nonnull<ArrayType>(typeAt(L)))
    L.item() = {0};
}

void AccessResult::enterScalar(Location &L) const {
  enterElement(L);
  while (auto *T = dyn_cast_or_null<StructType>(typeAt(L))) {
    if (T->isOpaque() || T->getNumElements() == 0 || L.Path.size() >= MaxPath)
      return;
    enterField(L, T, 0);
    enterElement(L);
  }
}

/// Adds the scalars of an object of type \p T at \p L, which begins \p At bytes
/// behind the beginning of an access, as far as the \p Size bytes of that go.
void AccessResult::addParts(const Location &L, Type *T, int64_t At,
                            uint64_t Size,
                            SmallVectorImpl<ScalarPart> &Out) const {
  if (!T->isSized() || At >= static_cast<int64_t>(Size) ||
      Out.size() >= MaxLocations)
    return;
  if (T->isArrayTy()) {
    Type *Element = elementOf(T);
    int64_t Bytes = Layout->getTypeAllocSize(Element).getFixedValue();
    int64_t End = Layout->getTypeAllocSize(T).getFixedValue();
    int64_t Begin = Bytes && At < 0 ? -At / Bytes * Bytes : 0;
    for (int64_t Here = Begin;
         Bytes && Here < End && At + Here < static_cast<int64_t>(Size) &&
         Out.size() < MaxLocations;
         Here += Bytes) {
      Location Inner = L;
      Inner.item() = Nth().plus(Here / Bytes);
      addParts(Inner, Element, At + Here, Size, Out);
    }
    return;
  }
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
  bool IsOne = L.isOne();
  size_t First = Out.size();
  uint64_t At = 0;
  while (true) {
    // Of an array the elements that follow, as far as it goes.
    if (Type *Whole = declaredTypeAt(L); Whole && Whole->isArrayTy()) {
      uint64_t Bytes =
          Layout->getTypeAllocSize(elementOf(Whole)).getFixedValue();
      At += L.item().isNumber() ? L.item().Number * Bytes : 0;
      L.item() = {};
      if (!L.isField() ||
          At + Size <= Layout->getTypeAllocSize(Whole).getFixedValue()) {
        addParts(L, Whole, -static_cast<int64_t>(At), Size, Out);
        break;
      }
    }
    if (!L.isField())
      return false;
    Step Last = L.Path.pop_back_val();
    StructType *Class = Numbers.typeOf(Last.Type);
    const StructLayout *Fields = Layout->getStructLayout(Class);
    At += Fields->getElementOffset(Last.Index);
    Type *Outer = declaredTypeAt(L);
    bool IsOutermost = !L.isField() && !(Outer && Outer->isArrayTy());
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
    break;
  }
  // Where it begins is not known: any elements.
  if (!IsOne)
    for (ScalarPart &Part : drop_begin(Out, First))
      Part.Where.widenAll();
  return true;
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
    if (Object.Root != L.Root || !Object.RootItem.mayBe(L.RootItem) ||
        Path.size() < Object.Path.size() ||
        !equal(Path.take_front(Object.Path.size()), Object.Path))
      return std::nullopt;
    return SmallVector<Step, 4>(Path.drop_front(Object.Path.size()));
  }
  for (size_t K = 1; K <= Path.size(); ++K) {
    Location Front{L.Root, SmallVector<Step, 4>(Path.take_front(K)),
                   L.RootItem};
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

} // namespace tpc
