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
/// or the nearest of its bases at the beginning of the object; empty if none
/// does.
static StringRef declaredIn(const DICompositeType &Class, unsigned Slot) {
  const DICompositeType *First = nullptr;
  for (const DINode *N : Class.getElements()) {
    if (const auto *Method = dyn_cast_or_null<DISubprogram>(N);
        Method && Method->getVirtuality() && Method->getVirtualIndex() == Slot)
      return Method->getLinkageName();
    const auto *Base = dyn_cast_or_null<DIDerivedType>(N);
    if (Base && Base->getTag() == dwarf::DW_TAG_inheritance &&
        Base->getOffsetInBits() == 0 && !First)
      First = dyn_cast_or_null<DICompositeType>(
          DebugTypes::plain(Base->getBaseType()));
  }
  return First ? declaredIn(*First, Slot) : "";
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
      StringRef Name = Class->isForwardDecl()
                           ? Tables.symbolAt(nameWithScopes(*Class), How->Slot)
                           : declaredIn(*Class, How->Slot);
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
