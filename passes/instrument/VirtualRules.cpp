//===- VirtualRules.cpp ---------------------------------------------------===//
#include "instrument/VirtualRules.h"

#include "Rules.h"
#include "calls/ClassHierarchy.h"
#include "params/ParameterObjects.h"
#include "support/DebugTypes.h"

#include "llvm/BinaryFormat/Dwarf.h"

using namespace llvm;

namespace tpc {

/// The mangled name of the virtual function that \p Class declares in \p Slot,
/// or one of its bases at the beginning of the object; of a class whose
/// members are not known, what \p Tables has. Empty if none does.
static StringRef declaredIn(const DICompositeType &Class, unsigned Slot,
                            const Rules &Tables) {
  if (Class.isForwardDecl())
    return Tables.symbolAt(nameWithScopes(Class), Slot);
  if (const DISubprogram *Method = virtualIn(Class, Slot))
    return Method->getLinkageName();
  for (const DINode *N : Class.getElements())
    if (const auto *Base = dyn_cast_or_null<DIDerivedType>(N);
        Base && Base->getTag() == dwarf::DW_TAG_inheritance &&
        Base->getOffsetInBits() == 0)
      if (const auto *First = dyn_cast_or_null<DICompositeType>(
              DebugTypes::plain(Base->getBaseType())))
        if (StringRef Name = declaredIn(*First, Slot, Tables); !Name.empty())
          return Name;
  return "";
}

/// The function \p Name for \p Call; added to \p M if it is not there. Null if
/// a function of another type has the name.
static Function *functionFor(const CallBase &Call, StringRef Name, Module &M) {
  Function *F = M.getFunction(Name);
  if (F)
    return F->getFunctionType() == Call.getFunctionType() ? F : nullptr;
  F = Function::Create(Call.getFunctionType(), GlobalValue::ExternalLinkage,
                       Name, M);
  F->setAttributes(Call.getAttributes());
  return F;
}

void nameVirtualCalls(Module &M, const Rules &Tables) {
  DebugTypes Debug(M.getDataLayout());
  SmallVector<std::pair<CallBase *, StringRef>, 16> Found;
  for (Function &F : definedFunctions(M))
    for (Instruction &I : instructions(F)) {
      auto *Call = dyn_cast<CallBase>(&I);
      auto How = Call && Call->isIndirectCall() ? ClassHierarchy::match(*Call)
                                                : std::nullopt;
      const auto *Class =
          How ? dyn_cast_or_null<DICompositeType>(Debug.pointee(How->Object))
              : nullptr;
      if (!Class)
        continue;
      StringRef Name = declaredIn(*Class, How->Slot, Tables);
      if (!Name.empty() && Tables.hasRow(Name))
        Found.push_back({Call, Name});
    }
  for (auto [Call, Name] : Found) {
    bool IsNew = !M.getFunction(Name);
    Function *F = functionFor(*Call, Name, M);
    if (F && Tables.match(*F).Row)
      Call->setCalledFunction(F);
    else if (F && IsNew)
      F->eraseFromParent();
  }
}

} // namespace tpc
