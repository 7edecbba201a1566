//===- AccessBuilder.cpp - Records the accesses ---------------------------===//
#include "memory/AccessBuilder.h"

#include "support/Budget.h"
#include "support/Functions.h"
#include "support/Names.h"
#include "support/Print.h"

#include "llvm/IR/InstIterator.h"
#include "llvm/IR/IntrinsicInst.h"

using namespace llvm;

namespace tpc {

void AccessBuilder::addWrite(Instruction &I, const Location &L) {
  R.WritesByObject.add(R.PartWrites.size(), L);
  R.PartWrites.push_back({&I, L});
}

/// \p Call may write any part of the object at \p L.
void AccessBuilder::addHanded(CallBase &Call, const Location &L) {
  addWrite(Call, L);
  R.HandedIndex.add(R.Handed.size(), L);
  R.Handed.push_back({&Call, L});
}

void AccessBuilder::addCopy(Instruction &I, Locations To, Locations From) {
  unsigned Number = R.Copies.size();
  for (const Location &L : To) {
    R.TargetIndex.add(R.Targets.size(), L);
    R.Targets.push_back({Number, L});
    addWrite(I, L);
  }
  for (const Location &L : From) {
    R.SourceIndex.add(R.Sources.size(), L);
    R.Sources.push_back({Number, L});
  }
  R.Copies.push_back({&I, std::move(To), std::move(From)});
}

/// The arguments of \p Call, a container method, go into the elements: the
/// objects themselves, and the elements of other containers.
void AccessBuilder::putInto(CallBase &Call) {
  const Value *Container = containerOf(Call);
  Locations To;
  Pointers.addElements(Container, To);
  for (const Use &Arg : Call.args()) {
    if (Arg.get() == Container || !Arg->getType()->isPointerTy() ||
        (Call.hasStructRetAttr() && Arg.getOperandNo() == 0))
      continue;
    Locations From = Pointers.resolve(Arg, false);
    Pointers.addElements(Arg, From);
    addCopy(Call, To, std::move(From));
  }
}

/// The object that \p Call leaves unchanged: \p Call is a const method, or a
/// container method that adds no elements.
static const Value *constantObject(const CallBase &Call,
                                   const ContainerMethod *Method) {
  const Function *Callee = Call.getCalledFunction();
  bool IsConst = Method ? !Method->Writes
                        : Callee && Callee->getName().starts_with("_ZNK");
  return IsConst ? containerOf(Call) : nullptr;
}

/// The container that \p Call, a method of it, puts its arguments into. The
/// arguments are not written, except containers that give up their elements.
static const Value *filledBy(const CallBase &Call,
                             const ContainerMethod *Method) {
  const Function *Callee = Call.getCalledFunction();
  if (!Method || !Method->Writes || !Callee)
    return nullptr;
  std::string Name = qualifiedName(Callee->getName());
  static constexpr StringRef GiveUp[] = {"swap", "merge", "splice"};
  if (is_contained(GiveUp, StringRef(Name).rsplit(':').second))
    return nullptr;
  return containerOf(Call);
}

/// The object to which \p Call, described by \p Row, always gives a new value:
/// the variable of a read with a default, or text that is made or assigned.
static const Value *alwaysReplaced(const CallBase &Call, const Rule &Row) {
  if (Row.Kind == Rule::Read && Row.Value && Row.Default)
    return argument(Call, Row, Row.Value);
  if (Row.Kind == Rule::Text && Row.Method && Row.Relation == "copy")
    return objectOf(Call, Row);
  return nullptr;
}

/// Records that \p Call replaces the object at \p Pointer.
void AccessBuilder::fileReplacing(CallBase &Call, const Value *Pointer) {
  const Locations Where = Pointers.handed(Pointer, /*IsOne=*/true);
  if (Where.empty())
    return;
  Type *T = R.Types.typeAt(Where.front());
  if (!T || !T->isSized() ||
      any_of(Where, [&](const Location &L) { return R.Types.typeAt(L) != T; }))
    return;
  R.Replacements.push_back(
      {&Call, Pointer,
       M.getDataLayout().getTypeStoreSize(T).getKnownMinValue()});
  if (Where.size() == 1 && Where.front().isOne())
    R.Replaced[&Call] = Where.front();
}

/// True if argument \p N of \p Call points to a single object, not into an
/// array: the object of a method, or the variable of a read.
static bool takesOne(const CallBase &Call, unsigned N, const Rule *Row) {
  if (Row && Row->Kind == Rule::Read && Row->Value &&
      argument(Call, *Row, Row->Value) == Call.getArgOperand(N))
    return true;
  const Function *Callee = Call.getCalledFunction();
  return N == (Call.hasStructRetAttr() ? 1 : 0) && Callee &&
         Callee->getName().starts_with("_ZN");
}

/// True if \p Call, of a function whose body is not analysed, cannot write the
/// object that its argument \p N points to.
bool AccessBuilder::isConstArgument(const CallBase &Call, unsigned N) {
  const Function *Callee = Call.getCalledFunction();
  if (!Callee)
    return false;
  auto [It, IsNew] = ConstArguments.try_emplace(Callee);
  if (IsNew)
    It->second = constArguments(*Callee);
  return N < It->second.size() && It->second.test(N);
}

/// True if \p Call calls a destructor.
static bool isDestructor(const CallBase &Call) {
  const Function *Callee = Call.getCalledFunction();
  return Callee && Call.arg_size() == 1 && Callee->getName().contains("D") &&
         StringRef(qualifiedName(Callee->getName())).contains("::~");
}

/// Records the fields that \p Copy copies behind the first one: a compiler
/// copies neighbouring fields of a class at once, by a pointer to the first.
void AccessBuilder::fileFurtherFields(MemTransferInst &Copy) {
  const auto *Bytes = dyn_cast<ConstantInt>(Copy.getLength());
  if (!Bytes || Bytes->getValue().getActiveBits() > 32)
    return;
  uint64_t Size = Bytes->getZExtValue();
  auto Fields = [&](const Value *Pointer) {
    SmallVector<ScalarPart, 8> Parts;
    for (Location &L : Pointers.resolve(Pointer, /*Scalar=*/false)) {
      Type *T = L.isField() ? R.Types.typeAt(L) : nullptr;
      if (!T || !T->isSized() ||
          M.getDataLayout().getTypeAllocSize(T).getKnownMinValue() >= Size)
        continue;
      R.Types.enterScalar(L);
      R.Types.addScalars(L, Size, Parts);
    }
    return Parts;
  };
  const SmallVector<ScalarPart, 8> From = Fields(Copy.getRawSource());
  for (const ScalarPart &To : Fields(Copy.getRawDest()))
    for (const ScalarPart &Of : From)
      if (To.Low == Of.Low && To.Low != 0)
        addCopy(Copy, {To.Where}, {Of.Where});
}

/// Records what \p Call can write.
void AccessBuilder::fileCall(CallBase &Call) {
  // Calls that only query a text do not write it.
  const Rule *Row = Rules.match(Call);
  if (Row && Row->Kind == Rule::Text && Row->Relation != "copy")
    return;
  bool Opaque = Calls.callees(Call).empty();
  if (Calls.onlyDestroys(Call) || (Opaque && isDestructor(Call)))
    return;
  if (const Value *Pointer = Row ? alwaysReplaced(Call, *Row) : nullptr)
    fileReplacing(Call, Pointer);
  const ContainerMethod *Method = Rules.container(Call);
  if (Method && Method->Writes)
    putInto(Call);
  const Value *Constant = constantObject(Call, Method);
  const Value *Filled = filledBy(Call, Method);
  for (const auto &[N, Arg] : enumerate(Call.args())) {
    if (!Arg->getType()->isPointerTy() || Call.onlyReadsMemory(N))
      continue;
    bool IsPutIn = Filled && Arg.get() != Filled &&
                   !Call.paramHasAttr(N, Attribute::StructRet);
    bool IsConst = Arg.get() == Constant;
    bool IsLeftAlone =
        IsPutIn || (Opaque && (IsConst || isConstArgument(Call, N)));
    if (IsLeftAlone)
      R.Unchanged.insert(&Call.getArgOperandUse(N));
    if (IsLeftAlone || IsConst)
      continue;
    for (const Location &L : Pointers.handed(Arg, takesOne(Call, N, Row))) {
      const auto *Global = dyn_cast_or_null<GlobalVariable>(L.Root);
      if (Global && Global->isConstant())
        continue;
      if (Opaque)
        addHanded(Call, L);
      else
        addWrite(Call, L);
    }
  }
}

void AccessBuilder::fileAccesses() {
  for (Function &F : definedFunctions(M)) {
    if (Rules.isOpaque(F))
      continue;
    for (Instruction &I : instructions(F)) {
      if (Budget::isSpent())
        return;
      if (auto *Load = dyn_cast<LoadInst>(&I)) {
        for (const Location &L : Pointers.touched(*Load)) {
          R.LoadIndex.add(R.Loads.size(), L);
          R.Loads.push_back({&I, L});
        }
      } else if (auto *Store = dyn_cast<StoreInst>(&I)) {
        for (const Location &L : Pointers.touched(*Store)) {
          R.StoreIndex.add(R.Stores.size(), L);
          R.Stores.push_back({&I, L});
          addWrite(I, L);
        }
      } else if (auto *Copy = dyn_cast<MemTransferInst>(&I)) {
        addCopy(I, Pointers.covered(*Copy, Copy->getRawDest()),
                Pointers.covered(*Copy, Copy->getRawSource()));
        fileFurtherFields(*Copy);
      } else if (auto *Fill = dyn_cast<MemSetInst>(&I);
                 Fill && !isa<Constant>(Fill->getLength())) {
        // With a constant length it is how a compiler writes initial zeros.
        for (const Location &L : Pointers.covered(*Fill, Fill->getRawDest()))
          addHanded(*Fill, L);
      } else if (auto *Call = dyn_cast<CallBase>(&I);
                 Call && !isa<IntrinsicInst>(Call)) {
        fileCall(*Call);
      }
    }
  }
}

} // namespace tpc
