//===- Instances.cpp ------------------------------------------------------===//
#include "instrument/Instances.h"

#include "control/IfStatements.h"

#include "llvm/ADT/SmallPtrSet.h"
#include "llvm/BinaryFormat/Dwarf.h"
#include "llvm/IR/DebugInfoMetadata.h"
#include "llvm/IR/Operator.h"

using namespace llvm;

namespace tpc {

/// How many steps of arithmetic the search for a threshold's field goes back.
static constexpr unsigned MaxSteps = 32;

const DICompositeType *classOf(const Function &F) {
  const DISubprogram *SP = F.getSubprogram();
  return SP ? dyn_cast_or_null<DICompositeType>(SP->getScope()) : nullptr;
}

Argument *objectOf(Function &F) {
  const DISubprogram *SP = F.getSubprogram();
  if (!classOf(F) || !SP->getType())
    return nullptr;
  // The first type is that of the result.
  DITypeRefArray Of = SP->getType()->getTypeArray();
  if (Of.size() < 2 || !Of[1] || !Of[1]->isObjectPointer())
    return nullptr;
  unsigned Number = F.hasStructRetAttr() ? 1 : 0;
  if (F.arg_size() <= Number || !F.getArg(Number)->getType()->isPointerTy())
    return nullptr;
  return F.getArg(Number);
}

/// \p V without field accesses.
static Value *objectBelow(Value *V) {
  while (auto *GEP = dyn_cast<GEPOperator>(V))
    V = GEP->getPointerOperand();
  return V;
}

Instances::Instances(const AnalysedModule &Analysed, DebugTypes &Types,
                     ArrayRef<ParameterRead> Reads)
    : Analysed(Analysed), Types(Types) {
  for (const ParameterRead &Read : Reads) {
    addReader(classOf(*Read.Call->getFunction()));
    // A method that was inlined.
    for (const DILocation *At = Read.Call->getDebugLoc(); At;
         At = At->getInlinedAt())
      addReader(dyn_cast_or_null<DICompositeType>(
          At->getScope()->getSubprogram()->getScope()));
    if (Value *Target = Read.Target; Target && isa<GEPOperator>(Target))
      addReader(Types.pointee(objectBelow(Target)));
  }
}

void Instances::addReader(const DIType *T) {
  const auto *Class = dyn_cast_or_null<DICompositeType>(DebugTypes::plain(T));
  // A closure is made again for each call.
  if (Class && !Class->getName().empty() &&
      Readers.insert(Types.numberOf(Class)).second)
    addParts(*Class);
}

void Instances::addParts(const DICompositeType &Class) {
  for (const DINode *Element : Class.getElements()) {
    const auto *Part = dyn_cast_or_null<DIDerivedType>(Element);
    if (!Part || Part->isStaticMember() ||
        (Part->getTag() != dwarf::DW_TAG_member &&
         Part->getTag() != dwarf::DW_TAG_inheritance))
      continue;
    const auto *Of = dyn_cast_or_null<DICompositeType>(
        DebugTypes::plain(Part->getBaseType()));
    if (Of && Parts.insert(Types.numberOf(Of)).second)
      addParts(*Of);
  }
}

bool Instances::isDerived(const DICompositeType &Class) {
  for (const DINode *Element : Class.getElements()) {
    const auto *Base = dyn_cast_or_null<DIDerivedType>(Element);
    if (!Base || Base->getTag() != dwarf::DW_TAG_inheritance)
      continue;
    const auto *Of = dyn_cast_or_null<DICompositeType>(
        DebugTypes::plain(Base->getBaseType()));
    if (Of && (Readers.contains(Types.numberOf(Of)) || isDerived(*Of)))
      return true;
  }
  return false;
}

bool Instances::isInstance(const DIType *T) {
  const auto *Class = dyn_cast_or_null<DICompositeType>(DebugTypes::plain(T));
  if (!Class || Class->getName().empty())
    return false;
  unsigned Number = Types.numberOf(Class);
  return Readers.contains(Number) || Parts.contains(Number) ||
         isDerived(*Class);
}

/// The instance in a field of which \p Threshold, or what it was computed from,
/// is; null if there is none.
Value *Instances::holderOf(Value *Threshold) {
  SmallVector<Value *, 8> Open{Threshold};
  SmallPtrSet<Value *, 8> Seen;
  for (size_t At = 0; At < Open.size() && At < MaxSteps; ++At) {
    auto *I = dyn_cast<Instruction>(Open[At]);
    if (!I || !Seen.insert(I).second)
      continue;
    if (auto *Load = dyn_cast<LoadInst>(I)) {
      Value *Object = objectBelow(Load->getPointerOperand());
      if (isa<Argument, LoadInst>(Object) && isInstance(Types.pointee(Object)))
        return Object;
      continue;
    }
    if (isa<CastInst, BinaryOperator, UnaryOperator, CmpInst, SelectInst>(I))
      append_range(Open, I->operands());
  }
  return nullptr;
}

bool Instances::dominates(const Value &V, Instruction &Before) {
  const auto *I = dyn_cast<Instruction>(&V);
  if (!I)
    return isa<Argument>(V) &&
           cast<Argument>(V).getParent() == Before.getFunction();
  if (I->getFunction() != Before.getFunction())
    return false;
  std::unique_ptr<DominatorTree> &Tree = Trees[Before.getFunction()];
  if (!Tree)
    Tree = std::make_unique<DominatorTree>(*Before.getFunction());
  return Tree->dominates(I, &Before);
}

Value *Instances::objectOf(const Comparison &C, Instruction &Before) {
  Argument *Own = tpc::objectOf(*Before.getFunction());
  Value *Threshold = C.Compare     ? C.Compare->getOperand(C.Threshold)
                     : C.FlagValue ? C.FlagValue
                                   : conditionOf(*C.Predicate);
  if (Value *Holder = holderOf(Threshold)) {
    // What was `this` in the source is so in the analysed copy, unless the
    // method was inlined there.
    if (const auto *A = dyn_cast<Argument>(Holder)) {
      Function &F = *Before.getFunction();
      if (A->getParent()->getName() == F.getName() &&
          A->getArgNo() < F.arg_size())
        return F.getArg(A->getArgNo());
    } else if (Value *There = Analysed.original(Holder);
               There && There->getType()->isPointerTy() &&
               dominates(*There, Before)) {
      return There;
    }
  }
  return Own && isInstance(classOf(*Before.getFunction())) ? Own : nullptr;
}

} // namespace tpc
