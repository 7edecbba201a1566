//===- Pointers.cpp - From a pointer to locations -------------------------===//
#include "memory/ClassObjectAccess.h"

#include "llvm/IR/Instructions.h"
#include "llvm/IR/Operator.h"
#include "llvm/IR/PatternMatch.h"

using namespace llvm;

namespace tpc {

/// More elements of one array are any of them for a pointer.
static constexpr unsigned MaxItems = 8;

void AccessResult::addTo(Locations &Out, Location L) const {
  auto IsIn = [&](const Location &Other) {
    return any_of(Out, [&](const Location &K) { return K.isSame(Other); });
  };
  if (!L.isKnown() || Out.size() >= MaxLocations || IsIn(L))
    return;
  if (L.item().isNumber() && Out.size() >= MaxItems) {
    Location Any = L;
    Any.widen();
    if (static_cast<unsigned>(count(Out, Any)) >= MaxItems) {
      if (!IsIn(Any))
        Out.push_back(std::move(Any));
      return;
    }
  }
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

/// Where \p L is in an array, moves it on by \p Index objects of type \p Unit,
/// each an element or some.
void AccessResult::moveOn(Location &L, const Value *Index, Type *Unit) const {
  Type *Array = declaredTypeAt(L);
  if (!isa_and_nonnull<ArrayType>(Array) || !Unit->isSized())
    return;
  const auto *By = dyn_cast<ConstantInt>(Index);
  uint64_t Bytes = Layout->getTypeAllocSize(elementOf(Array)).getFixedValue();
  uint64_t Own = Layout->getTypeAllocSize(Unit).getFixedValue();
  if (By && By->isZero())
    return;
  bool Known = By && By->getValue().getSignificantBits() <= 32 && Bytes &&
               Own % Bytes == 0 && Own / Bytes <= Nth::Most;
  L.item() = Known ? L.item().plus(By->getSExtValue() *
                                   static_cast<int64_t>(Own / Bytes))
                   : Nth{Nth::Any};
}

/// Makes of a place in an array of scalars any place there; false elsewhere.
bool AccessResult::anyElement(Location &L) const {
  Type *Declared = declaredTypeAt(L);
  if (!isa_and_nonnull<ArrayType>(Declared))
    return false;
  L.item() = {Nth::Any};
  return !elementOf(Declared)->isStructTy();
}

/// Goes the way of \p GEP from \p L.
void AccessResult::follow(Location &L, const GEPOperator &GEP) const {
  Type *T = GEP.getSourceElementType();
  const DIType *Source = Debug->pointee(GEP.getPointerOperand());
  moveOn(L, GEP.idx_begin()->get(), T);
  for (const Use &U : drop_begin(GEP.indices())) {
    if (auto *Struct = dyn_cast<StructType>(T)) {
      unsigned Field = cast<ConstantInt>(U.get())->getZExtValue();
      const DICompositeType *Class = Debug->asStruct(Source, Struct);
      enterElement(L);
      L.Path.push_back(
          {Numbers.numberOf(Struct), Field, Debug->numberOf(Class)});
      Source = Debug->field(Class, Struct, Field);
      T = Struct->getElementType(Field);
    } else {
      T = GetElementPtrInst::getTypeAtIndex(T, U.get());
      enterElement(L);
      moveOn(L, U.get(), T);
    }
  }
}

/// True for one type, and for one class that was read from two files.
bool AccessResult::isAlike(Type *A, Type *B) const {
  auto *S = dyn_cast<StructType>(A), *T = dyn_cast<StructType>(B);
  return A == B || (S && T && Numbers.numberOf(S) == Numbers.numberOf(T));
}

/// True where \p GEP leads into a class, or from one object to the next.
static bool entersClass(const GEPOperator &GEP) {
  Type *T = GEP.getSourceElementType();
  if (T->isStructTy())
    return true;
  for (const Use &U : drop_begin(GEP.indices())) {
    if (T->isStructTy())
      return true;
    T = GetElementPtrInst::getTypeAtIndex(T, U.get());
  }
  return false;
}

/// Goes \p Offset bytes into \p L, and with \p Until no further than to an
/// object of that class, or an element of that type in an array; takes the way
/// off \p Offset. False where nothing begins there.
bool AccessResult::descend(Location &L, int64_t &Offset, Type *Until) const {
  while (true) {
    Type *Whole = declaredTypeAt(L), *T = elementOf(Whole);
    if (!T || !T->isSized())
      return false;
    bool InArray = Whole->isArrayTy();
    if (int64_t Bytes = Layout->getTypeAllocSize(T).getFixedValue();
        InArray && Bytes) {
      int64_t By =
          Offset >= 0 ? Offset / Bytes : -((Bytes - 1 - Offset) / Bytes);
      enterElement(L);
      if (L.item().isNumber() && L.item().Number + By < 0)
        return false;
      L.item() = L.item().plus(By);
      Offset -= By * Bytes;
    }
    auto *Class = dyn_cast<StructType>(T);
    if (Until && Offset == 0 && (Class || InArray) && isAlike(T, Until))
      return true;
    if (Offset < 0)
      return false;
    if (!Class || Class->isOpaque() || Class->getNumElements() == 0)
      return Offset == 0 && !Until;
    const StructLayout *Fields = Layout->getStructLayout(Class);
    if (static_cast<uint64_t>(Offset) >= Fields->getSizeInBytes() ||
        L.Path.size() >= MaxPath)
      return false;
    unsigned Field = Fields->getElementContainingOffset(Offset);
    enterField(L, Class, Field);
    Offset -= Fields->getElementOffset(Field);
  }
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
  // A pointer that is an element further each time it is computed.
  bool Walks = !Rooted && !isa<Argument>(Base);
  for (const Location &L : Objects)
    followChain(L, Chain, Walks, Out);
}

/// Adds the place that \p Chain, the nearest to \p L last, leads to from there.
/// Where the pointer to it \p Walks, it can be many elements further.
void AccessResult::followChain(Location L, ArrayRef<const GEPOperator *> Chain,
                               bool Walks, Locations &Out) const {
  if (L.Root && isa<CallBase>(L.Root) &&
      (L.Path.empty() || L.Path.back().Type == Step::Bytes)) {
    // Where the way says which class it is, all objects of it are meant.
    if (none_of(Chain, [](const GEPOperator *GEP) {
          const auto *S = dyn_cast<StructType>(GEP->getSourceElementType());
          return S && !S->isLiteral();
        }))
      addAllocated(L, Chain, Out);
    return;
  }
  bool Unknown = !L.isKnown();
  size_t Length = L.Path.size();
  int64_t Bytes = 0;
  bool Valid = true;
  for (const GEPOperator *GEP : reverse(Chain)) {
    Type *Source = GEP->getSourceElementType();
    Type *Element = elementOf(Source);
    auto *Struct = dyn_cast<StructType>(Element);
    // By bytes, or by the shape that the calling convention gives an object
    // in registers: the way has to be found in the object itself.
    if ((Struct && Struct->isLiteral()) || Source->isIntegerTy(8)) {
      APInt Offset(Layout->getIndexTypeSizeInBits(GEP->getType()), 0);
      if (GEP->accumulateConstantOffset(*Layout, Offset))
        Bytes += Offset.getSExtValue();
      else if (Bytes || !anyElement(L))
        Valid = false;
      continue;
    }
    if (L.isElement()) {
      if (!Struct)
        continue;
      Bytes = 0;
      Valid = true;
      Location Way;
      follow(Way, *GEP);
      extend(L, Way.Path);
      continue;
    }
    // A base class, or what a pointer of another type was made of.
    Type *Declared = declaredTypeAt(L);
    if (L.isKnown() && (Bytes != 0 || elementOf(Declared) != Element ||
                        (!Struct && !Declared->isArrayTy()))) {
      Location Inner = L;
      int64_t Rest = Bytes;
      bool Found = descend(Inner, Rest, Element);
      // A number that is in no array is what it is, however far one goes; what
      // it is a part of may be another element.
      if (!Found && !entersClass(*GEP)) {
        if (!GEP->hasAllZeroIndices()) {
          anyElement(L);
          L.widenAll();
        }
        continue;
      }
      L = Found ? Inner : Location();
    }
    Bytes = 0;
    Valid |= Struct != nullptr;
    if (Walks && L.Path.size() <= Length &&
        !match(GEP->idx_begin()->get(), PatternMatch::m_Zero()))
      anyElement(L);
    follow(L, *GEP);
  }
  if (!Valid || !L.isKnown() || (Unknown && Chain.empty()))
    return;
  if (Bytes == 0 || L.isElement() || descend(L, Bytes, nullptr))
    addTo(Out, std::move(L));
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

Locations AccessResult::handed(const Value *Pointer, bool IsOne) const {
  Locations All;
  for (Location &L : resolve(Pointer, false)) {
    if (IsOne)
      enterElement(L);
    else
      L.widen();
    addTo(All, std::move(L));
  }
  return All;
}

/// What \p Copy takes from or puts to \p Pointer: one element where it is no
/// larger than that.
Locations AccessResult::copied(const MemTransferInst &Copy,
                               const Value *Pointer) const {
  const auto *Bytes = dyn_cast<ConstantInt>(Copy.getLength());
  return handed(
      Pointer, Bytes && all_of(resolve(Pointer, false), [&](const Location &L) {
                 Type *T = elementOf(typeAt(L));
                 return T && T->isSized() &&
                        Bytes->getValue().ule(
                            Layout->getTypeAllocSize(T).getFixedValue());
               }));
}

} // namespace tpc
