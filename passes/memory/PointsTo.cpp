//===- PointsTo.cpp -------------------------------------------------------===//
#include "memory/PointsTo.h"

#include "calls/SimpleCallGraph.h"
#include "memory/PointsToSolver.h"
#include "support/Functions.h"
#include "support/Names.h"

#include "llvm/IR/InstIterator.h"
#include "llvm/IR/Instructions.h"
#include "llvm/IR/Operator.h"
#include "llvm/IR/PatternMatch.h"

#include <limits>

using namespace llvm;

namespace tpc {

AnalysisKey PointsToAnalysis::Key;

const Value *containerOf(const CallBase &Call) {
  unsigned N = Call.hasStructRetAttr() ? 1 : 0;
  return N < Call.arg_size() ? Call.getArgOperand(N) : nullptr;
}

/// True for calls that allocate memory, or return an object of their own.
static bool isAllocation(const Value *V) {
  const auto *Call = dyn_cast<CallBase>(V);
  if (Call && Call->hasMetadata(OwnObjectName))
    return true;
  const Function *Callee = Call ? Call->getCalledFunction() : nullptr;
  static constexpr StringRef Names[] = {
      "_Znwm",  "_Znam", "_ZnwmSt11align_val_t", "_ZnamSt11align_val_t",
      "malloc", "calloc"};
  return Callee && is_contained(Names, Callee->getName());
}

/// Adds the place that \p Chain leads to in the allocation at \p L. The type
/// there is not known, but the offset is, or it is any element of an array. If
/// the pointer \p Walks, it is moved on by \p Chain again and again.
void PointsTo::addAllocated(const Location &L,
                            ArrayRef<const GEPOperator *> Chain, bool Walks,
                            Locations &Out) {
  // A library allocates for many objects at one place: vectors, matrices.
  bool IsArray =
      !Chain.empty() && Sources.has(*cast<CallBase>(L.Root)->getFunction());
  Location Here = L;
  int64_t Bytes = L.RootItem.isNumber() ? L.RootItem.Number : 0;
  bool Known = L.RootItem.Number != Nth::Any;
  for (const GEPOperator *GEP : Chain) {
    APInt Offset(Layout.getIndexTypeSizeInBits(GEP->getType()), 0);
    bool IsConstant = GEP->accumulateConstantOffset(Layout, Offset);
    if (!IsConstant && !IsArray)
      return;
    Known &= IsConstant && !(Walks && IsArray);
    if (IsConstant)
      Bytes += Offset.getSExtValue();
  }
  if (Known && Bytes < 0)
    return;
  if (!Known)
    Here.RootItem = {Nth::Any};
  else if (Bytes)
    Here.RootItem = {static_cast<unsigned>(
        std::min<int64_t>(Bytes, std::numeric_limits<int>::max()))};
  else
    Here.RootItem = {};
  addTo(Out, std::move(Here));
}

/// True if \p GEP leads into a class, or from one object to the next.
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

/// The pointer that \p V is a cast of.
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

const Value *PointsTo::baseOf(const Value *Pointer) {
  const Value *Base = throughCasts(Pointer);
  while (const auto *GEP = dyn_cast<GEPOperator>(Base))
    Base = throughCasts(GEP->getPointerOperand());
  return Base;
}

/// Adds the locations that \p Pointer can lead to, given what is known so far
/// about the pointers that it is computed from.
void PointsTo::addPointees(const Value *Pointer, Locations &Out) {
  SmallVector<const GEPOperator *, 4> Chain;
  const Value *Base = throughCasts(Pointer);
  while (const auto *GEP = dyn_cast<GEPOperator>(Base)) {
    if (!GEP->hasAllZeroIndices() || GEP->getNumIndices() > 1)
      Chain.push_back(GEP);
    Base = throughCasts(GEP->getPointerOperand());
  }
  bool Rooted = isa<GlobalVariable>(Base) || isa<AllocaInst>(Base);
  // A pointer that moves on by an element each time it is computed.
  bool Walks = !Rooted && !isa<Argument>(Base);
  auto Follow = [&](const Location &L) {
    if (!isa_and_nonnull<CallBase>(L.Root) || !L.Path.empty())
      followChain(L, Chain, Walks, Out);
    // If the path names the class, it means all objects of the class.
    else if (none_of(Chain, [](const GEPOperator *GEP) {
               const auto *S =
                   dyn_cast<StructType>(GEP->getSourceElementType());
               return S && !S->isLiteral();
             }))
      addAllocated(L, Chain, isa<PHINode>(Base), Out);
  };
  // Besides the known objects there are unknown ones. Of those only the path is
  // known, from its first class on.
  if (!Rooted && !Complete.contains(Base))
    Follow(Location());
  if (Rooted || isAllocation(Base))
    Follow({Base, {}});
  else if (auto It = Targets.find(Base); It != Targets.end())
    for_each(It->second, Follow);
}

/// Adds the place that \p Chain, whose last element is next to \p L, leads to
/// from \p L. If the pointer \p Walks, it can be many elements further on.
void PointsTo::followChain(Location L, ArrayRef<const GEPOperator *> Chain,
                           bool Walks, Locations &Out) {
  bool Unknown = !L.isKnown();
  size_t Length = L.Path.size();
  int64_t Bytes = 0;
  bool Valid = true;
  for (const GEPOperator *GEP : reverse(Chain)) {
    Type *Source = GEP->getSourceElementType();
    Type *Element = elementOf(Source);
    auto *Struct = dyn_cast<StructType>(Element);
    // By bytes, or in the shape that the calling convention gives an object in
    // registers: the path must be found in the object itself.
    if ((Struct && Struct->isLiteral()) || Source->isIntegerTy(8)) {
      APInt Offset(Layout.getIndexTypeSizeInBits(GEP->getType()), 0);
      if (GEP->accumulateConstantOffset(Layout, Offset))
        Bytes += Offset.getSExtValue();
      else if (Bytes || !Types.anyElement(L))
        Valid = false;
      continue;
    }
    if (L.isElement()) {
      if (!Struct)
        continue;
      Bytes = 0;
      Valid = true;
      Location Way;
      Types.follow(Way, *GEP);
      Types.extend(L, Way.Path);
      continue;
    }
    // A base class, or an object that a pointer of another type was made from.
    Type *Declared = Types.declaredTypeAt(L);
    if (L.isKnown() && (Bytes != 0 || elementOf(Declared) != Element ||
                        (!Struct && !Declared->isArrayTy()))) {
      Location Inner = L;
      int64_t Rest = Bytes;
      bool Found = Types.descend(Inner, Rest, Element);
      // A scalar outside of any array stays itself, however far the pointer
      // moves; an object that contains it may be another element.
      if (!Found && !entersClass(*GEP)) {
        if (!GEP->hasAllZeroIndices()) {
          Types.anyElement(L);
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
      Types.anyElement(L);
    Types.follow(L, *GEP);
  }
  if (!Valid || !L.isKnown() || (Unknown && Chain.empty()))
    return;
  if (Bytes == 0 || L.isElement() || Types.descend(L, Bytes, nullptr))
    addTo(Out, std::move(L));
}

Locations PointsTo::resolve(const Value *Pointer, bool Scalar) {
  Locations Found;
  addPointees(Pointer, Found);
  if (!Scalar)
    return Found;
  Locations Entered;
  for (Location &L : Found) {
    Types.enterScalar(L);
    addTo(Entered, std::move(L));
  }
  return Entered;
}

Locations PointsTo::handed(const Value *Pointer, bool IsOne) {
  Locations All;
  for (Location &L : resolve(Pointer, false)) {
    if (IsOne)
      Types.enterElement(L);
    else
      L.widen();
    addTo(All, std::move(L));
  }
  return All;
}

SmallVector<ScalarPart, 1> PointsTo::partsOf(const Instruction &I) {
  Type *T = getLoadStoreType(const_cast<Instruction *>(&I));
  SmallVector<ScalarPart, 1> Parts;
  for (Location &L : resolve(getLoadStorePointerOperand(&I), true))
    if (!(T->isAggregateType() || T->isIntegerTy() || T->isVectorTy()) ||
        !Types.addScalars(L, Layout.getTypeStoreSize(T).getKnownMinValue(),
                          Parts))
      Parts.push_back({std::move(L)});
  return Parts;
}

Locations PointsTo::touched(const Instruction &I) {
  Locations All;
  for (ScalarPart &Part : partsOf(I))
    addTo(All, std::move(Part.Where));
  return All;
}

Locations PointsTo::covered(const MemIntrinsic &I, const Value *Pointer) {
  const auto *Bytes = dyn_cast<ConstantInt>(I.getLength());
  return handed(
      Pointer, Bytes && all_of(resolve(Pointer, false), [&](const Location &L) {
                 Type *T = elementOf(Types.typeAt(L));
                 return T && T->isSized() &&
                        Bytes->getValue().ule(
                            Layout.getTypeAllocSize(T).getFixedValue());
               }));
}

void PointsTo::addElements(const Value *Container, Locations &Out) {
  for (Location L : resolve(Container, false)) {
    // The elements of a container that is an element count as its own: a list
    // may contain lists of its own class.
    if (!L.isElement())
      L.Path.push_back({Step::Element, 0});
    addTo(Out, std::move(L));
  }
}

PointsTo PointsToAnalysis::run(Module &M, ModuleAnalysisManager &AM) {
  PointsTo R(M.getDataLayout(), AM.getResult<LocationTypesAnalysis>(M),
             UserSources(AM.getResult<OptionsAnalysis>(M)));
  PointsToSolver(R, AM.getResult<AliasesAnalysis>(M),
                 AM.getResult<SimpleCallGraph>(M),
                 AM.getResult<RuleAnalysis>(M), M)
      .findTargets();
  return R;
}

PreservedAnalyses PointsToPrinter::run(Module &M, ModuleAnalysisManager &AM) {
  PointsTo &R = AM.getResult<PointsToAnalysis>(M);
  const LocationTypes &Types = AM.getResult<LocationTypesAnalysis>(M);
  OS << "pointers of " << M.getName() << '\n';
  auto Print = [&](const Value &V, const Function &F) {
    if (!V.getType()->isPointerTy() || isa<AllocaInst>(V))
      return;
    OS << "  ";
    V.printAsOperand(OS, false);
    OS << " in " << F.getName();
    const Locations Found = R.resolve(&V, /*Scalar=*/false);
    OS << (Found.empty() ? " leads nowhere that is known" : " leads to");
    for (const Location &L : Found) {
      OS << ' ';
      Types.print(OS, L);
    }
    OS << '\n';
  };
  for (const Function &F : definedFunctions(M)) {
    for (const Argument &Arg : F.args())
      Print(Arg, F);
    for (const Instruction &I : instructions(F))
      Print(I, F);
  }
  return PreservedAnalyses::all();
}

} // namespace tpc
