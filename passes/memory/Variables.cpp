//===- Variables.cpp ------------------------------------------------------===//
#include "memory/Variables.h"

#include "support/Compat.h"
#include "support/Names.h"

#include "llvm/IR/DebugInfo.h"
#include "llvm/IR/IntrinsicInst.h"
#include "llvm/IR/Module.h"

using namespace llvm;

namespace tpc {

bool isMultiplyAdd(const Instruction &I) {
  const auto *Call = dyn_cast<IntrinsicInst>(&I);
  return Call && (Call->getIntrinsicID() == Intrinsic::fmuladd ||
                  Call->getIntrinsicID() == Intrinsic::fma);
}

std::string localName(const Value &V, const Function &F) {
  for (const DbgVariableRecord *R : variableRecords(const_cast<Value *>(&V)))
    if (R->getVariable()->getScope()->getSubprogram() == F.getSubprogram())
      return R->getVariable()->getName().str();
  return "";
}

std::pair<const DICompositeType *, StringRef>
VariableNames::fieldOf(const Location &L) const {
  // The innermost field that the source names. The inside of a std::string, for
  // example, is not known to the user.
  for (const Step &S : reverse(L.Path))
    if (StringRef Name = Types.fieldName(S); !Name.empty())
      return {Types.sourceClassOf(S), Name};
  return {nullptr, ""};
}

std::string VariableNames::rootName(const Value *Root) const {
  if (const auto *Global = dyn_cast_or_null<GlobalVariable>(Root)) {
    SmallVector<DIGlobalVariableExpression *, 1> Infos;
    Global->getDebugInfo(Infos);
    return Infos.empty() ? "" : Infos.front()->getVariable()->getName().str();
  }
  if (const auto *Local = dyn_cast_or_null<AllocaInst>(Root))
    for (DbgVariableRecord *R :
         findDVRDeclares(const_cast<AllocaInst *>(Local)))
      return R->getVariable()->getName().str();
  return "";
}

std::string VariableNames::nameOf(const Location &L) const {
  StringRef Field = fieldOf(L).second;
  return Field.empty() ? rootName(L.Root) : Field.str();
}

std::string VariableNames::fullNameOf(const Location &L) const {
  // Such names belong to the standard library, inside a container or smart
  // pointer of the user.
  Location Own = L;
  auto [Class, Field] = fieldOf(Own);
  while (Field.starts_with("_")) {
    Own.Path.pop_back();
    std::tie(Class, Field) = fieldOf(Own);
  }
  if (Field.empty())
    return rootName(L.Root);
  StringRef Plain = Class->getName().split('<').first;
  if (isMessageClass(*Class))
    Plain.consume_back("_");
  return Plain.empty() ? Field.str() : (Plain + "::" + Field).str();
}

std::string VariableNames::nameOf(const Value *V, PointsTo &Pointers) const {
  while (const auto *Cast = dyn_cast<CastInst>(V))
    V = Cast->getOperand(0);
  if (const auto *Arg = dyn_cast<Argument>(V))
    return localName(*Arg, *Arg->getParent());
  const auto *I = dyn_cast<Instruction>(V);
  if (!I)
    return "";
  if (std::string Name = localName(*V, *I->getFunction()); !Name.empty())
    return Name;
  if (const auto *Load = dyn_cast<LoadInst>(V)) {
    const Value *Pointer = Load->getPointerOperand();
    if (const auto *Reference = dyn_cast<Argument>(Pointer))
      if (std::string Name = localName(*Reference, *Reference->getParent());
          !Name.empty())
        return Name;
    for (const Location &L : Pointers.resolve(Pointer, true))
      if (std::string Name = nameOf(L); !Name.empty())
        return Name;
  }
  const auto *Call = dyn_cast<CallBase>(V);
  // The number in an object has the name of the object.
  if (Call && Call->getCalledFunction() &&
      Call->getCalledFunction()->getName() == TakeName) {
    for (const Location &L : Pointers.handed(Call->getArgOperand(0), true))
      if (std::string Name = nameOf(L); !Name.empty())
        return Name;
    return "";
  }
  return Call && Call->getCalledFunction() && !isMultiplyAdd(*Call)
             ? calleeName(*Call)
             : "";
}

} // namespace tpc
