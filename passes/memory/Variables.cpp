//===- Variables.cpp ------------------------------------------------------===//
#include "memory/Variables.h"

#include "llvm/IR/DebugInfo.h"
#include "llvm/IR/Module.h"

using namespace llvm;

namespace tpc {

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
  // ROS messages are typedefs of `Name_<Allocator>`.
  auto [Plain, Arguments] = Class->getName().split('<');
  if (!Arguments.empty())
    Plain.consume_back("_");
  return Plain.empty() ? Field.str() : (Plain + "::" + Field).str();
}

} // namespace tpc
