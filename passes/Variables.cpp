//===- Variables.cpp ------------------------------------------------------===//
#include "Variables.h"

#include "Names.h"

#include "llvm/BinaryFormat/Dwarf.h"
#include "llvm/IR/DebugInfo.h"
#include "llvm/IR/Module.h"

using namespace llvm;

namespace tpc {

/// `ns::Outer::Inner`, without template arguments, as LLVM names the struct.
static std::string sourceName(const DIType &T) {
  std::string Name = T.getName().split('<').first.str();
  for (const DIScope *S = T.getScope(); S; S = S->getScope()) {
    if (!isa<DINamespace>(S) && !isa<DICompositeType>(S))
      break;
    StringRef Outer = S->getName().split('<').first;
    if (Outer.empty())
      Outer = "(anonymous namespace)";
    Name = (Outer + "::" + Name).str();
  }
  return Name;
}

VariableNames::VariableNames(const Module &M, const TypeNumbers &Types)
    : Layout(M.getDataLayout()), Types(Types) {
  DebugInfoFinder Finder;
  Finder.processModule(M);
  for (const DIType *T : Finder.types())
    if (const auto *Class = dyn_cast<DICompositeType>(T);
        Class && !Class->getElements().empty() && !Class->getName().empty())
      Classes[sourceName(*Class)].push_back(Class);
}

/// The member of \p Class that begins at \p Bits; empty where none does.
static std::string memberAt(const DICompositeType &Class, uint64_t Bits) {
  for (const DINode *N : Class.getElements())
    if (const auto *Member = dyn_cast_or_null<DIDerivedType>(N);
        Member && Member->getTag() == dwarf::DW_TAG_member &&
        !Member->isStaticMember() && Member->getOffsetInBits() == Bits)
      return Member->getName().str();
  return "";
}

std::string VariableNames::nameOf(const Location &L) const {
  for (const Step &S : reverse(L.Path)) {
    StructType *T = Types.typeOf(S.Type);
    auto It = Classes.find(plainClassName(*T));
    if (It == Classes.end() || T->isOpaque())
      continue;
    uint64_t Bits = Layout.getStructLayout(T)->getElementOffsetInBits(S.Index);
    for (const DICompositeType *Class : It->second)
      if (std::string Name = memberAt(*Class, Bits); !Name.empty())
        return Name;
  }
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
