//===- ClassHierarchy.cpp -------------------------------------------------===//
#include "calls/ClassHierarchy.h"

#include "llvm/ADT/SmallPtrSet.h"
#include "llvm/IR/Constants.h"
#include "llvm/IR/Instructions.h"
#include "llvm/IR/Operator.h"

using namespace llvm;

namespace tpc {

bool fits(const CallBase &Call, const Function &F) {
  const FunctionType *A = Call.getFunctionType(), *B = F.getFunctionType();
  return A->getReturnType() == B->getReturnType() &&
         A->params().equals(B->params());
}

std::optional<VirtualCall> ClassHierarchy::match(const CallBase &Call) {
  const auto *Entry = dyn_cast<LoadInst>(Call.getCalledOperand());
  if (!Entry)
    return std::nullopt;
  const Value *Table = Entry->getPointerOperand();
  unsigned Slot = 0;
  if (const auto *GEP = dyn_cast<GEPOperator>(Table)) {
    if (!GEP->getSourceElementType()->isPointerTy() ||
        GEP->getNumIndices() != 1 || !isa<ConstantInt>(GEP->getOperand(1)))
      return std::nullopt;
    Slot = cast<ConstantInt>(GEP->getOperand(1))->getZExtValue();
    Table = GEP->getPointerOperand();
  }
  const auto *Vptr = dyn_cast<LoadInst>(Table);
  if (!Vptr || Call.arg_empty())
    return std::nullopt;
  // The object is the first argument, or the second if the first is where the
  // result goes.
  const Value *Object = Vptr->getPointerOperand()->stripPointerCasts();
  for (unsigned N = 0; N < std::min<unsigned>(2, Call.arg_size()); ++N)
    if (Call.getArgOperand(N)->stripPointerCasts() == Object)
      return VirtualCall{Object, Slot};
  return std::nullopt;
}

unsigned ClassHierarchy::numberOf(StringRef Name) {
  auto [It, New] = Numbers.try_emplace(Name, Classes.size());
  if (New)
    Classes.emplace_back().Name = It->first();
  return It->second;
}

/// The number in an entry of a vtable, which is null or a number as pointer.
static int64_t asNumber(const Constant *Entry) {
  const auto *Cast = dyn_cast<ConstantExpr>(Entry);
  const auto *Number = Cast && Cast->getOpcode() == Instruction::IntToPtr
                           ? dyn_cast<ConstantInt>(Cast->getOperand(0))
                           : nullptr;
  return Number ? Number->getSExtValue() : 0;
}

/// `_ZTV4Base`: for each address point, the offset to the top, the type
/// information and the functions.
void ClassHierarchy::addTable(const GlobalVariable &Variable) {
  const auto *Parts = dyn_cast<ConstantStruct>(Variable.getInitializer());
  if (!Parts)
    return;
  SmallVector<Group, 1> Found;
  // If several files have a class of the same name, the linker renames the
  // tables. Their type information still says which class each belongs to.
  StringRef Name = Variable.getName();
  for (const Use &U : Parts->operands()) {
    const auto *Entries = dyn_cast<ConstantArray>(U.get());
    if (!Entries)
      continue;
    // Before the functions stand offsets to virtual bases, the offset to the
    // top and the type information, which is the last global that is not a
    // function.
    unsigned Begin = 2;
    for (unsigned N = 0; N < Entries->getNumOperands(); ++N)
      if (const auto *Info = dyn_cast<GlobalVariable>(
              Entries->getOperand(N)->stripPointerCasts());
          Info && Info->getName().starts_with("_ZTI")) {
        Name = Info->getName();
        Begin = N + 1;
      }
    int64_t Top = Begin < 2 || Entries->getNumOperands() < 2
                      ? 0
                      : asNumber(Entries->getOperand(Begin - 2));
    Group &G = Found.emplace_back(Group{-Top, {}, Found.empty()});
    for (unsigned N = Begin; N < Entries->getNumOperands(); ++N)
      G.Functions.push_back(
          dyn_cast<Function>(Entries->getOperand(N)->stripPointerCasts()));
  }
  unsigned Number = numberOf(Name.drop_front(4));
  append_range(Classes[Number].Table, std::move(Found));
  addObjects(Variable, Number);
}

/// True if \p Address is the first element of \p Object.
static bool beginsWith(const Constant *Object, const Constant *Address) {
  while (Object && Object != Address)
    Object = isa<ConstantAggregate>(Object) ? Object->getAggregateElement(0U)
                                            : nullptr;
  return Object;
}

/// Finds the class of \p Table through the objects that hold its address:
/// `this` in a constructor or destructor, or a global object without a
/// constructor.
void ClassHierarchy::addObjects(const GlobalVariable &Table, unsigned Number) {
  auto Add = [&](const Value *Object) {
    const auto *Class =
        dyn_cast_or_null<DICompositeType>(Debug.pointee(Object));
    if (Class && Class->getIdentifier().empty())
      OfOneFile.try_emplace(Class, Number);
  };
  SmallPtrSet<const Constant *, 4> Known;
  SmallVector<const Constant *, 4> Addresses;
  for (const User *U : Table.users())
    if (const auto *Address = dyn_cast<ConstantExpr>(U))
      Addresses.push_back(Address);
  for (const Constant *Address : Addresses) {
    SmallVector<const User *, 4> Users(Address->users());
    while (!Users.empty()) {
      const User *U = Users.pop_back_val();
      if (const auto *Store = dyn_cast<StoreInst>(U)) {
        const auto *This = dyn_cast<Argument>(Store->getPointerOperand());
        if (This && This->getArgNo() == 0 &&
            This->getParent()->getParent() == Table.getParent())
          Add(This);
      } else if (const auto *Global = dyn_cast<GlobalVariable>(U)) {
        if (Global->getParent() == Table.getParent() &&
            beginsWith(Global->getInitializer(), Address))
          Add(Global);
      } else if (const auto *Outer = dyn_cast<ConstantAggregate>(U)) {
        if (Known.insert(Outer).second)
          append_range(Users, Outer->users());
      }
    }
  }
}

std::optional<unsigned>
ClassHierarchy::find(const DICompositeType &Class) const {
  if (auto It = OfOneFile.find(&Class); It != OfOneFile.end())
    return It->second;
  const std::string Identifier = DebugTypes::identifierOf(Class);
  StringRef Name = Identifier;
  if (!Name.consume_front("_ZTS"))
    return std::nullopt;
  auto It = Numbers.find(Name);
  return It == Numbers.end() ? std::nullopt : std::optional(It->second);
}

/// `_ZTI4Base`: the third element is the base of a class with one base at its
/// beginning. Other classes have the number of bases, then each base and its
/// offset (from bit 8 on).
void ClassHierarchy::addBases(const GlobalVariable &TypeInfo) {
  const auto *Info = dyn_cast<ConstantStruct>(TypeInfo.getInitializer());
  if (!Info || Info->getNumOperands() < 3)
    return;
  unsigned Own = numberOf(TypeInfo.getName().drop_front(4));
  auto Add = [&](const Constant *Base, int64_t Offset) {
    const auto *Variable = dyn_cast<GlobalVariable>(Base->stripPointerCasts());
    if (Variable && Variable->getName().starts_with("_ZTI")) {
      unsigned Number = numberOf(Variable->getName().drop_front(4));
      Classes[Number].Derived.push_back({Own, Offset});
      Classes[Own].Bases.push_back({Number, Offset});
    }
  };
  if (Info->getNumOperands() == 3)
    return Add(Info->getOperand(2), 0);
  for (unsigned N = 4; N + 1 < Info->getNumOperands(); N += 2) {
    const auto *Where = dyn_cast<ConstantInt>(Info->getOperand(N + 1));
    // Bit 0 says that the base is virtual.
    bool IsFixed = Where && !(Where->getZExtValue() & 1);
    Add(Info->getOperand(N), IsFixed ? Where->getSExtValue() >> 8 : Virtual);
  }
}

ClassHierarchy::ClassHierarchy(Module &M) : Debug(M.getDataLayout()) {
  for (const GlobalVariable &G : M.globals())
    if (G.hasInitializer()) {
      if (G.getName().starts_with("_ZTV"))
        addTable(G);
      else if (G.getName().starts_with("_ZTI"))
        addBases(G);
    }
}

void ClassHierarchy::collect(unsigned Number, bool AtBeginning, unsigned Slot,
                             const CallBase &Call,
                             SmallVectorImpl<Function *> &Out) {
  const Class &C = Classes[Number];
  for (const Group &G : C.Table) {
    // A base that is not at the beginning has its table further on.
    if (AtBeginning != G.IsFirst || Slot >= G.Functions.size())
      continue;
    Function *F = G.Functions[Slot];
    if (F && fits(Call, *F) && !is_contained(Out, F))
      Out.push_back(F);
  }
  for (const Relative &D : C.Derived)
    collect(D.Class, AtBeginning && D.Offset == 0, Slot, Call, Out);
}

/// Adds the bases of \p C that begin \p Offset bytes into it.
void ClassHierarchy::addBasesAt(const Class &C, int64_t Offset,
                                SmallVectorImpl<StringRef> &Out) const {
  for (const Relative &B : C.Bases) {
    if (B.Offset == Virtual || B.Offset > Offset)
      continue;
    const Class &Base = Classes[B.Class];
    if (B.Offset == Offset && !is_contained(Out, Base.Name))
      Out.push_back(Base.Name);
    addBasesAt(Base, Offset - B.Offset, Out);
  }
}

void ClassHierarchy::forEachFunction(
    function_ref<void(const VirtualFunction &)> Fn) const {
  for (const Class &C : Classes)
    for (const Group &G : C.Table) {
      SmallVector<StringRef, 4> Bases;
      addBasesAt(C, G.Offset, Bases);
      for (const auto &[Slot, F] : enumerate(G.Functions))
        if (F)
          Fn({F, static_cast<unsigned>(Slot), Bases});
    }
}

void ClassHierarchy::addFunctions(
    StringRef Name, SmallSetVector<const Function *, 4> &Out) const {
  auto It = Numbers.find(Name);
  if (It == Numbers.end())
    return;
  SmallSetVector<unsigned, 8> Work;
  Work.insert(It->second);
  for (unsigned N = 0; N < Work.size(); ++N) {
    const Class &C = Classes[Work[N]];
    for (const Group &G : C.Table)
      for (const Function *F : G.Functions)
        if (F)
          Out.insert(F);
    for (const Relative &D : C.Derived)
      Work.insert(D.Class);
  }
}

/// `4Node` for the class `N2ns4NodeIdE`; empty for names of other forms.
static StringRef ownName(StringRef Mangled) {
  Mangled.consume_front("N");
  StringRef Own;
  while (true) {
    StringRef Rest = Mangled;
    size_t Length;
    if (Rest.consumeInteger(10, Length) || Length > Rest.size())
      return Own;
    Own = Mangled.take_front(Mangled.size() - Rest.size() + Length);
    Mangled = Rest.drop_front(Length);
  }
}

void ClassHierarchy::addFunctionsOfNamed(
    StringRef Mangled, SmallSetVector<const Function *, 4> &Out) const {
  for (const Class &C : Classes)
    if (StringRef Own = ownName(C.Name); !Own.empty() && Mangled.contains(Own))
      addFunctions(C.Name, Out);
}

SmallVector<Function *, 4> ClassHierarchy::targets(const CallBase &Call,
                                                   const VirtualCall &How) {
  SmallVector<Function *, 4> Found;
  const auto *Class =
      dyn_cast_or_null<DICompositeType>(Debug.pointee(How.Object));
  if (std::optional<unsigned> Number = Class ? find(*Class) : std::nullopt)
    collect(*Number, /*AtBeginning=*/true, How.Slot, Call, Found);
  return Found;
}

} // namespace tpc
