//===- LocationTypes.cpp --------------------------------------------------===//
#include "memory/LocationTypes.h"

#include "llvm/IR/Instructions.h"
#include "llvm/IR/Module.h"
#include "llvm/IR/Operator.h"

using namespace llvm;

namespace tpc {

AnalysisKey LocationTypesAnalysis::Key;

LocationTypes LocationTypesAnalysis::run(Module &M, ModuleAnalysisManager &AM) {
  return LocationTypes(M, AM.getResult<DebugTypesAnalysis>(M));
}

LocationTypes::LocationTypes(const Module &M, DebugTypes &Debug)
    : Layout(M.getDataLayout()), Debug(Debug) {
  findClassesOfGlobals(M);
}

Type *elementOf(Type *T) {
  while (auto *Array = dyn_cast_or_null<ArrayType>(T))
    T = Array->getElementType();
  return T;
}

void LocationTypes::findClassesOfGlobals(const Module &M) {
  // The types of a module are collected only when needed; few modules need
  // them.
  std::optional<std::vector<StructType *>> All;
  for (const GlobalVariable &Global : M.globals()) {
    const auto *T = dyn_cast<StructType>(Global.getValueType());
    if (!T || !T->isLiteral() || !Debug.pointee(&Global))
      continue;
    if (!All)
      All = M.getIdentifiedStructTypes();
    if (StructType *Class = Debug.classOf(Global, *All))
      ClassOfGlobal[&Global] = Class;
  }
}

Type *LocationTypes::declaredTypeAt(const Location &L) const {
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

Type *LocationTypes::typeAt(const Location &L) const {
  Type *T = declaredTypeAt(L);
  return L.item().Number == Nth::Whole ? T : elementOf(T);
}

/// The source's type of the object at \p L; null if it is not known.
const DIType *LocationTypes::debugTypeAt(const Location &L) const {
  if (L.Path.empty())
    return L.Root ? Debug.pointee(L.Root) : nullptr;
  const Step &Last = L.Path.back();
  if (!Last.isField())
    return nullptr;
  return sourceTypeOf(Last);
}

StringRef LocationTypes::fieldName(const Step &S) const {
  const DICompositeType *Class = sourceClassOf(S);
  return Class ? Debug.fieldName(Class, classOf(S), S.Index) : "";
}

bool LocationTypes::isConst(const Step &S) const {
  return Debug.isConst(sourceClassOf(S), classOf(S), S.Index);
}

const DIType *LocationTypes::sourceTypeOf(const Step &S) const {
  return Debug.field(sourceClassOf(S), classOf(S), S.Index);
}

void LocationTypes::enterField(Location &L, StructType *T, unsigned Field) {
  unsigned Class = Debug.numberOf(Debug.asStruct(debugTypeAt(L), T));
  L.Path.push_back({Numbers.numberOf(T), Field, Class});
}

void LocationTypes::enterElement(Location &L) const {
  if (isa_and_nonnull<ArrayType>(typeAt(L)))
    L.setItem({0});
}

void LocationTypes::enterScalar(Location &L) {
  enterElement(L);
  // In an allocation, the scalar at its beginning.
  if (isa_and_nonnull<CallBase>(L.Root) && L.Path.empty() &&
      L.RootItem.Number == Nth::Whole)
    L.RootItem = {0};
  while (auto *T = dyn_cast_or_null<StructType>(typeAt(L))) {
    if (T->isOpaque() || T->getNumElements() == 0 || L.Path.size() >= MaxPath)
      return;
    enterField(L, T, 0);
    enterElement(L);
  }
}

void LocationTypes::extend(Location &L, ArrayRef<Step> Steps) const {
  if (L.isElement())
    Steps = Steps.drop_while(
        [&](const Step &S) { return Numbers.isStandard(S.Type); });
  L.Path.append(Steps);
}

/// If \p L is in an array, moves it by \p Index objects of type \p Unit, each
/// of which is one element or several.
void LocationTypes::moveOn(Location &L, const Value *Index, Type *Unit) const {
  Type *Array = declaredTypeAt(L);
  if (!isa_and_nonnull<ArrayType>(Array) || !Unit->isSized())
    return;
  const auto *By = dyn_cast<ConstantInt>(Index);
  uint64_t Bytes = Layout.getTypeAllocSize(elementOf(Array)).getFixedValue();
  uint64_t Own = Layout.getTypeAllocSize(Unit).getFixedValue();
  if (By && By->isZero())
    return;
  bool Known = By && By->getValue().getSignificantBits() <= 32 && Bytes &&
               Own % Bytes == 0 && Own / Bytes <= Nth::Most;
  L.setItem(Known ? L.item().plus(By->getSExtValue() *
                                  static_cast<int64_t>(Own / Bytes))
                  : Nth{Nth::Any});
}

bool LocationTypes::anyElement(Location &L) const {
  Type *Declared = declaredTypeAt(L);
  if (!isa_and_nonnull<ArrayType>(Declared))
    return false;
  L.setItem({Nth::Any});
  return !elementOf(Declared)->isStructTy();
}

void LocationTypes::follow(Location &L, const GEPOperator &GEP) {
  Type *T = GEP.getSourceElementType();
  const DIType *Source = Debug.pointee(GEP.getPointerOperand());
  moveOn(L, GEP.idx_begin()->get(), T);
  for (const Use &U : drop_begin(GEP.indices())) {
    if (auto *Struct = dyn_cast<StructType>(T)) {
      unsigned Field = cast<ConstantInt>(U.get())->getZExtValue();
      const DICompositeType *Class = Debug.asStruct(Source, Struct);
      enterElement(L);
      L.Path.push_back(
          {Numbers.numberOf(Struct), Field, Debug.numberOf(Class)});
      Source = Debug.field(Class, Struct, Field);
      T = Struct->getElementType(Field);
    } else {
      T = GetElementPtrInst::getTypeAtIndex(T, U.get());
      enterElement(L);
      moveOn(L, U.get(), T);
    }
  }
}

bool LocationTypes::isAlike(Type *A, Type *B) {
  auto *S = dyn_cast<StructType>(A), *T = dyn_cast<StructType>(B);
  return A == B || (S && T && Numbers.numberOf(S) == Numbers.numberOf(T));
}

bool LocationTypes::descend(Location &L, int64_t &Offset, Type *Until) {
  while (true) {
    Type *Whole = declaredTypeAt(L), *T = elementOf(Whole);
    if (!T || !T->isSized())
      return false;
    bool InArray = Whole->isArrayTy();
    if (auto Bytes =
            static_cast<int64_t>(Layout.getTypeAllocSize(T).getFixedValue());
        InArray && Bytes) {
      int64_t By =
          Offset >= 0 ? Offset / Bytes : -((Bytes - 1 - Offset) / Bytes);
      enterElement(L);
      if (L.item().isNumber() && L.item().Number + By < 0)
        return false;
      L.setItem(L.item().plus(By));
      Offset -= By * Bytes;
    }
    auto *Class = dyn_cast<StructType>(T);
    if (Until && Offset == 0 && (Class || InArray) && isAlike(T, Until))
      return true;
    if (Offset < 0)
      return false;
    if (!Class || Class->isOpaque() || Class->getNumElements() == 0)
      return Offset == 0 && !Until;
    const StructLayout *Fields = Layout.getStructLayout(Class);
    if (static_cast<uint64_t>(Offset) >= Fields->getSizeInBytes() ||
        L.Path.size() >= MaxPath)
      return false;
    unsigned Field = Fields->getElementContainingOffset(Offset);
    enterField(L, Class, Field);
    Offset -=
        static_cast<int64_t>(Fields->getElementOffset(Field).getFixedValue());
  }
}

/// Adds the scalars of an object of type \p T at \p L, which begins \p At bytes
/// after the beginning of an access of \p Size bytes, as far as the access
/// covers them.
void LocationTypes::addScalarsOf(const Location &L, Type *T, int64_t At,
                                 uint64_t Size,
                                 SmallVectorImpl<ScalarPart> &Out) {
  if (!T->isSized() || At >= static_cast<int64_t>(Size) ||
      Out.size() >= MaxLocations)
    return;
  if (T->isArrayTy()) {
    Type *Element = elementOf(T);
    auto Bytes =
        static_cast<int64_t>(Layout.getTypeAllocSize(Element).getFixedValue());
    auto End = static_cast<int64_t>(Layout.getTypeAllocSize(T).getFixedValue());
    int64_t Begin = Bytes && At < 0 ? -At / Bytes * Bytes : 0;
    for (int64_t Here = Begin;
         Bytes && Here < End && At + Here < static_cast<int64_t>(Size) &&
         Out.size() < MaxLocations;
         Here += Bytes) {
      Location Inner = L;
      Inner.setItem(Nth().plus(Here / Bytes));
      addScalarsOf(Inner, Element, At + Here, Size, Out);
    }
    return;
  }
  auto *Class = dyn_cast<StructType>(T);
  if (Class && Class->getNumElements() && L.Path.size() < MaxPath) {
    const StructLayout *Fields = Layout.getStructLayout(Class);
    for (unsigned Field = 0; Field < Class->getNumElements(); ++Field) {
      Location Inner = L;
      enterField(Inner, Class, Field);
      addScalarsOf(Inner, Class->getElementType(Field),
                   At + static_cast<int64_t>(Fields->getElementOffset(Field)),
                   Size, Out);
    }
  } else if (At >= 0 && L.isKnown()) {
    Out.push_back({L, static_cast<unsigned>(At * 8),
                   static_cast<unsigned>(
                       Layout.getTypeStoreSizeInBits(T).getFixedValue())});
  }
}

bool LocationTypes::addScalars(Location L, uint64_t Size,
                               SmallVectorImpl<ScalarPart> &Out) {
  Type *T = elementOf(typeAt(L));
  if (!T || !T->isSized() || Layout.getTypeStoreSize(T).getFixedValue() >= Size)
    return false;
  bool IsOne = L.isOne();
  size_t First = Out.size();
  uint64_t At = 0;
  while (true) {
    // In an array, the following elements are covered too.
    if (Type *Whole = declaredTypeAt(L); Whole && Whole->isArrayTy()) {
      uint64_t Bytes =
          Layout.getTypeAllocSize(elementOf(Whole)).getFixedValue();
      At += L.item().isNumber() ? L.item().Number * Bytes : 0;
      L.setItem({});
      if (!L.isField() ||
          At + Size <= Layout.getTypeAllocSize(Whole).getFixedValue()) {
        addScalarsOf(L, Whole, -static_cast<int64_t>(At), Size, Out);
        break;
      }
    }
    if (!L.isField())
      return false;
    Step Last = L.Path.pop_back_val();
    StructType *Class = Numbers.typeOf(Last.Type);
    const StructLayout *Fields = Layout.getStructLayout(Class);
    At += Fields->getElementOffset(Last.Index);
    Type *Outer = declaredTypeAt(L);
    bool IsOutermost = !L.isField() && !(Outer && Outer->isArrayTy());
    if (!IsOutermost && At + Size > Fields->getSizeInBytes())
      continue;
    for (unsigned Field = Last.Index; Field < Class->getNumElements();
         ++Field) {
      Location Inner = L;
      Inner.Path.push_back({Last.Type, Field, Last.Class});
      addScalarsOf(Inner, Class->getElementType(Field),
                   static_cast<int64_t>(Fields->getElementOffset(Field)) -
                       static_cast<int64_t>(At),
                   Size, Out);
    }
    break;
  }
  // Where the access begins is not known: any elements.
  if (!IsOne)
    for (ScalarPart &Part : drop_begin(Out, First))
      Part.Where.widenAll();
  return true;
}

void LocationTypes::addClassesIn(Type *T, SmallSetVector<unsigned, 8> &Out) {
  auto *Class = dyn_cast_or_null<StructType>(elementOf(T));
  if (!Class || Class->isOpaque() || !Out.insert(Numbers.numberOf(Class)))
    return;
  for (Type *Field : Class->elements())
    addClassesIn(Field, Out);
}

bool LocationTypes::contains(const Location &Outer, const Step &Inner) {
  // LLVM's types only have the layout, which classes share.
  return contains(typeAt(Outer), Inner.Type) &&
         Debug.mayContain(debugTypeAt(Outer), Inner.Class);
}

/// True if the layout of the class number \p Inner is \p Outer, or in it.
bool LocationTypes::contains(Type *Outer, unsigned Inner) {
  auto *T = dyn_cast_or_null<StructType>(elementOf(Outer));
  if (!T || T->isOpaque())
    return false;
  if (auto It = Contained.find({T, Inner}); It != Contained.end())
    return It->second;
  bool Is = Numbers.numberOf(T) == Inner ||
            any_of(T->elements(),
                   [&](Type *Field) { return contains(Field, Inner); });
  Contained[{T, Inner}] = Is;
  return Is;
}

static void print(raw_ostream &OS, Nth Item, StringRef Unit = "") {
  if (Item.isNumber())
    OS << '[' << Unit << Item.Number << ']';
  else if (Item.Number == Nth::Any)
    OS << "[any]";
}

void LocationTypes::print(raw_ostream &OS, const Location &L) const {
  if (L.Root)
    L.Root->printAsOperand(OS, false);
  tpc::print(OS, L.RootItem, isa_and_nonnull<CallBase>(L.Root) ? "byte " : "");
  for (const Step &S : L.Path) {
    if (!S.isField()) {
      OS << "[element]";
      continue;
    }
    const StructType *T = classOf(S);
    OS << '[' << (T->hasName() ? T->getName() : "literal") << '.' << S.Index
       << ']';
    tpc::print(OS, S.Item);
  }
}

} // namespace tpc
