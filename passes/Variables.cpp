//===- Variables.cpp ------------------------------------------------------===//
#include "Variables.h"

#include "llvm/IR/DebugInfo.h"
#include "llvm/IR/Module.h"

using namespace llvm;

namespace tpc {

std::string VariableNames::nameOf(const Location &L) const {
  // The innermost field that the source names: what is inside a std::string,
  // say, is not the user's to know.
  for (const Step &S : reverse(L.Path))
    if (const DICompositeType *Class = Debug.classOf(S.Class))
      if (StringRef Name =
              Debug.fieldName(Class, Types.typeOf(S.Type), S.Index);
          !Name.empty())
        return Name.str();
  if (const auto *Global = dyn_cast_or_null<GlobalVariable>(L.Root)) {
    SmallVector<DIGlobalVariableExpression *, 1> Infos;
    Global->getDebugInfo(Infos);
    return Infos.empty() ? "" : Infos.front()->getVariable()->getName().str();
  }
  if (const auto *Local = dyn_cast_or_null<AllocaInst>(L.Root))
    for (DbgVariableRecord *R :
         findDVRDeclares(const_cast<AllocaInst *>(Local)))
      return R->getVariable()->getName().str();
  return "";
}

} // namespace tpc
