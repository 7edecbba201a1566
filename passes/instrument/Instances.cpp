//===- Instances.cpp ------------------------------------------------------===//
#include "instrument/Instances.h"

#include "control/IfStatements.h"
#include "params/ParameterObjects.h"
#include "support/Names.h"

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
  for (const ParameterRead &Read : Reads)
    if (Read.Row->Kind == Rule::Config)
      Configs.insert(classArgument(*Read.Call->getCalledFunction()));
  for (const ParameterRead &Read : Reads) {
    addReader(classOf(*Read.Call->getFunction()), /*InMethod=*/true);
    // A method that was inlined.
    for (const DILocation *At = Read.Call->getDebugLoc(); At;
         At = At->getInlinedAt())
      addReader(dyn_cast_or_null<DICompositeType>(
                    At->getScope()->getSubprogram()->getScope()),
                /*InMethod=*/true);
    if (Value *Target = Read.Target; Target && isa<GEPOperator>(Target))
      addReader(Types.pointee(objectBelow(Target)), /*InMethod=*/false);
  }
}

bool Instances::isConfig(const DICompositeType &Class) const {
  return !Configs.empty() && Configs.contains(nameWithScopes(Class));
}

void Instances::addReader(const DIType *T, bool InMethod) {
  const auto *Class = dyn_cast_or_null<DICompositeType>(DebugTypes::plain(T));
  // A closure is made again for each call.
  if (!Class || Class->getName().empty() || isConfig(*Class))
    return;
  Readers.insert(Types.numberOf(Class));
  if (InMethod)
    Reading.insert(Types.numberOf(Class));
  addParts(*Class);
}

void Instances::addPart(const DICompositeType &Class) {
  if (isConfig(Class))
    return;
  Parts.insert(Types.numberOf(&Class));
  addParts(Class);
}

void Instances::addParts(const DICompositeType &Class) {
  // A class may be met as a declaration first.
  if (Class.isForwardDecl() || !Defined.insert(Types.numberOf(&Class)).second)
    return;
  for (const DINode *Element : Class.getElements()) {
    const auto *Part = dyn_cast_or_null<DIDerivedType>(Element);
    if (!Part || Part->isStaticMember() ||
        (Part->getTag() != dwarf::DW_TAG_member &&
         Part->getTag() != dwarf::DW_TAG_inheritance))
      continue;
    if (const auto *Of = dyn_cast_or_null<DICompositeType>(
            DebugTypes::plain(Part->getBaseType())))
      addPart(*Of);
  }
}

bool Instances::isDerived(const DICompositeType &Class,
                          const DenseSet<unsigned> &From) {
  for (const DINode *Element : Class.getElements()) {
    const auto *Base = dyn_cast_or_null<DIDerivedType>(Element);
    if (!Base || Base->getTag() != dwarf::DW_TAG_inheritance)
      continue;
    const auto *Of = dyn_cast_or_null<DICompositeType>(
        DebugTypes::plain(Base->getBaseType()));
    if (Of && (From.contains(Types.numberOf(Of)) || isDerived(*Of, From)))
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
         isDerived(*Class, Readers);
}

/// True if \p T is a class whose methods read parameters, or derived from one.
bool Instances::reads(const DIType *T) {
  const auto *Class = dyn_cast_or_null<DICompositeType>(DebugTypes::plain(T));
  return Class && (Reading.contains(Types.numberOf(Class)) ||
                   isDerived(*Class, Reading));
}

/// True if \p Object may be an instance whose fields are thresholds.
bool Instances::canHold(const Value &Object) {
  const DIType *T = Types.pointee(&Object);
  if (const auto *A = dyn_cast<Argument>(&Object))
    return isInstance(T) &&
           (A == tpc::objectOf(*const_cast<Function *>(A->getParent())) ||
            (reads(T) && !A->hasByValAttr()));
  return isa<LoadInst, PHINode, CallBase, SelectInst>(Object) && isInstance(T);
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
      if (canHold(*Object))
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
  Function &F = *Before.getFunction();
  Value *Holder = holderOf(Threshold);
  // A method that was inlined in the analysed copy has in the original program
  // its own object.
  if (Holder && C.place().getFunction()->getName() == F.getName()) {
    if (const auto *A = dyn_cast<Argument>(Holder))
      return A->getArgNo() < F.arg_size() ? F.getArg(A->getArgNo()) : nullptr;
    // The threshold is that of another object. Which one a value is that is
    // chosen at run time (phi, select) depends on the optimisation level.
    Value *There = isa<LoadInst>(Holder) ? Analysed.original(Holder) : nullptr;
    return There && There->getType()->isPointerTy() && dominates(*There, Before)
               ? There
               : nullptr;
  }
  return Own && isInstance(classOf(F)) ? Own : nullptr;
}

} // namespace tpc
