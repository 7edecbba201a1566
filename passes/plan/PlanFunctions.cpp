//===- PlanFunctions.cpp --------------------------------------------------===//
#include "plan/PlanFunctions.h"

#include "plan/Checksum.h"
#include "support/Names.h"

#include "llvm/IR/DebugInfoMetadata.h"

using namespace llvm;

namespace tpc {

//===----------------------------------------------------------------------===//
// The functions of a module
//===----------------------------------------------------------------------===//

std::string DefinedFunctions::placeOf(StringRef Linkage, StringRef File,
                                      uint64_t Line) {
  return (Linkage + "\n" + File + "\n" + Twine(Line)).str();
}

DefinedFunctions::DefinedFunctions(Module &M, StringRef Unit) : Unit(Unit) {
  for (Function &F : M) {
    if (F.isDeclarationForLinker() || F.getName().contains(CopyMark))
      continue;
    ByName[F.getName()] = &F;
    if (const DISubprogram *SP = F.getSubprogram())
      ByPlace[placeOf(sourceNameOf(F), pathOf(SP->getFile()), SP->getLine())]
          .push_back(&F);
  }
}

SmallVector<Function *, 1>
DefinedFunctions::candidates(const PlannedFunction &F) const {
  SmallVector<Function *, 1> All;
  if (!F.Unit.empty() && F.Unit != Unit)
    return All;
  Function *Named = ByName.lookup(F.Name);
  if (Named)
    All.push_back(Named);
  // A linker gives functions that only one file sees another name, if it is
  // taken. Several files may have the same one, from a header.
  auto Place = ByPlace.find(placeOf(F.Linkage, F.File, F.Line));
  if (Place != ByPlace.end())
    copy_if(Place->second, std::back_inserter(All), [&](Function *There) {
      return There != Named && There->hasLocalLinkage();
    });
  return All;
}

bool DefinedFunctions::hasChecksum(Function &F, StringRef Checksum) {
  auto [It, New] = Checksums.try_emplace(&F);
  if (New)
    It->second = checksumOf(F);
  return It->second == Checksum;
}

SmallVector<Function *, 1> DefinedFunctions::find(const PlannedFunction &F) {
  SmallVector<Function *, 1> Alike;
  for (Function *There : candidates(F))
    if (hasChecksum(*There, F.Checksum)) {
      if (There->getName() == F.Name)
        return {There};
      Alike.push_back(There);
    }
  return Alike;
}

//===----------------------------------------------------------------------===//
// The functions of a plan
//===----------------------------------------------------------------------===//

PlanFunctions::PlanFunctions(Module &M, const Plan &Of,
                             DefinedFunctions &Defined)
    : Of(Of), Found(Of.Functions.size()), Sets(Of.Functions.size()),
      Copies(Of.Functions.size()) {
  // An earlier plan may have copied functions.
  DenseMap<Function *, Set> Earlier;
  for (Function &F : M)
    if (F.getName().contains(CopyMark))
      if (Function *From = M.getFunction(nameOfOriginal(F)))
        Earlier[From].push_back(&F);
  for (auto [Number, F] : enumerate(Of.Functions)) {
    if (F.Of) {
      Copies[*F.Of].push_back(Number);
      continue;
    }
    Found[Number] = Defined.find(F);
    for (Function *Here : Found[Number]) {
      Sets[Number].push_back(Here);
      append_range(Sets[Number], Earlier.lookup(Here));
    }
  }
  // A function of the same name that is another one of the plan says nothing.
  DenseSet<Function *> Known;
  for (const Set &Here : Found)
    Known.insert(Here.begin(), Here.end());
  for (auto [Number, F] : enumerate(Of.Functions))
    if (!F.Of && Found[Number].empty() &&
        any_of(Defined.candidates(F),
               [&](Function *There) { return !Known.contains(There); }))
      Differing.insert(Number);
}

bool PlanFunctions::isServedHere(uint64_t Number) const {
  for (; Of.Functions[Number].Of; Number = *Of.Functions[Number].Of)
    if (!isServedHere(*Of.Functions[Number].In))
      return false;
  return isHere(Number);
}

/// Notes which function serves which of \p Calls, all calls of \p Number here.
void PlanFunctions::serve(uint64_t Number, ArrayRef<NumberedCall> Calls) {
  for (uint64_t Copy : Copies[Number]) {
    const PlannedFunction &F = Of.Functions[Copy];
    for (const NumberedCall &Each : Calls)
      if (Each.Number == *F.At &&
          is_contained(Sets[*F.In], Each.Call->getFunction()) &&
          !is_contained(Sets[Copy], Each.Call->getCalledFunction()))
        Sets[Copy].push_back(Each.Call->getCalledFunction());
  }
}

void PlanFunctions::separate(uint64_t Number, Copier &Round) {
  const bool HasOthers =
      any_of(Copies[Number], [&](uint64_t Copy) { return isForOthers(Copy); });
  // Copying changes no set of this number.
  for (Function *F : Sets[Number]) {
    SmallVector<NumberedCall, 8> Calls =
        Round.separate(F, /*KeepsOwn=*/!HasOthers);
    if (Calls.empty()) {
      Calls = callsOf(*F);
      // What cannot be copied would report all of its calls.
      if (Calls.size() + HasOthers > 1)
        continue;
    }
    for (const NumberedCall &Each : Calls)
      if (Function *Now = Each.Call->getCalledFunction(); Now != F)
        Made.emplace_back(F, Now);
    serve(Number, Calls);
    for (uint64_t Copy : Copies[Number])
      if (isForOthers(Copy) && !F->hasLocalLinkage() &&
          !F->getName().contains(CopyMark))
        Sets[Copy].push_back(F);
  }
}

void PlanFunctions::separate() {
  for (const std::vector<uint64_t> &Numbers : Of.Rounds) {
    Copier Round;
    for (uint64_t Number : Numbers)
      separate(Number, Round);
  }
}

void PlanFunctions::addCopies(const PlanFunctions &Later) {
  for (Set &Here : Sets)
    for (auto [From, To] : Later.Made)
      if (is_contained(Here, From) && !is_contained(Here, To))
        Here.push_back(To);
}

} // namespace tpc
