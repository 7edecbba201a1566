//===- VisibleWrites.cpp --------------------------------------------------===//
#include "memory/VisibleWrites.h"

#include "support/Functions.h"
#include "support/Print.h"

#include "llvm/Analysis/ValueTracking.h"
#include "llvm/IR/InstIterator.h"
#include "llvm/Support/CommandLine.h"

using namespace llvm;

namespace tpc {

AnalysisKey VisibleWritesAnalysis::Key;

VisibleWrites::VisibleWrites(Module &M, ModuleAnalysisManager &AM)
    : Layout(M.getDataLayout()), Types(AM.getResult<LocationTypesAnalysis>(M)),
      Alias(AM.getResult<AliasesAnalysis>(M)),
      Pointers(AM.getResult<PointsToAnalysis>(M)),
      Accesses(AM.getResult<ClassObjectAccess>(M)),
      Locals(M, AM.getResult<RuleAnalysis>(M), Types, Pointers, Accesses),
      Shared(M, AM.getResult<SimpleCallGraph>(M), AM.getResult<Throws>(M),
             AM.getResult<CalledBackAnalysis>(M), Accesses.replacements()),
      Messages(M, AM.getResult<SimpleCallGraph>(M),
               AM.getResult<DebugTypesAnalysis>(M), Types, Pointers, Accesses,
               UserSources(AM.getResult<OptionsAnalysis>(M))) {}

/// The writes of \p L, including those through copies of whole objects.
VisibleWrites::Writes VisibleWrites::allWrites(const Location &L) {
  AccessIndex::Found<Writes> Found = Accesses.writesOf(L);
  Found.Own.insert(Found.Copied.begin(), Found.Copied.end());
  return std::move(Found.Own);
}

/// Each write is compared with each read. A variable with more writes is
/// usually a buffer or a counter; all its writes count as visible.
static cl::opt<unsigned>
    MaxNarrowed("tpc-max-narrowed-writes", cl::Hidden, cl::init(64),
                cl::desc("Writes of one variable whose readers are computed"));

static bool isLocalOf(const Location &L, const Instruction &At) {
  const auto *Local = dyn_cast_or_null<AllocaInst>(L.Root);
  return Local && Local->getFunction() == At.getFunction();
}

/// The pointer of \p I, a load or store, if \p I touches all that it points to;
/// null if it touches only a part.
const Value *VisibleWrites::placeOf(const Instruction &I) {
  auto [It, New] = Places.try_emplace(&I, nullptr);
  if (New && none_of(Pointers.partsOf(I),
                     [](const ScalarPart &Part) { return Part.Size; }))
    It->second = getLoadStorePointerOperand(&I);
  return It->second;
}

/// The variable \p L at \p Pointer; none if \p Pointer is null.
std::optional<Reaching::Variable>
VisibleWrites::variableAt(const Value *Pointer, const Location &L) const {
  Type *T = elementOf(Types.typeAt(L));
  if (!Pointer || !T || !T->isSized())
    return std::nullopt;
  return Shared.variableAt(Pointer,
                           Layout.getTypeStoreSize(T).getKnownMinValue());
}

/// What \p Write, a write of \p L, writes; none if it may write less, or other
/// variables too.
std::optional<Reaching::Variable>
VisibleWrites::writtenBy(const Instruction &Write, const Location &L) const {
  if (!isa<StoreInst>(Write)) {
    const Location *Whole = Accesses.replacedBy(Write);
    if (!Whole || !Whole->mayEqual(L))
      return std::nullopt;
  }
  return Shared.replacedBy(Write);
}

bool VisibleWrites::replaces(const CallBase &Call, const Value *Pointer) const {
  std::optional<Reaching::Variable> Own = Shared.replacedBy(Call),
                                    V = Shared.variableAt(Pointer, 1);
  return Own && V && Own->Where == V->Where;
}

const VisibleWrites::SharedWrites &
VisibleWrites::sharedWrites(const Location &L) {
  auto [It, New] = ByVariable.try_emplace(L);
  SharedWrites &All = It->second;
  if (!New)
    return All;
  AccessIndex::Found<Writes> Found = Accesses.writesOf(L);
  // With too many writes, their readers are not computed.
  All.TooMany = Found.Own.size() + Found.Copied.size() > MaxNarrowed;
  if (All.TooMany) {
    Found.Own.insert(Found.Copied.begin(), Found.Copied.end());
    All.Own = Found.Own.takeVector();
    return All;
  }
  All.Own = Found.Own.takeVector();
  All.Copied = Found.Copied.takeVector();
  All.Narrowed = any_of(All.Own, [&](Instruction *Write) {
    return !Shared.isVisible(*Write, writtenBy(*Write, L));
  });
  return All;
}

bool VisibleWrites::isSharedBy(const Location &L, const Instruction &At,
                               const Value *Pointer) {
  if (isLocalOf(L, At) || Messages.has(Pointer))
    return false;
  const SharedWrites &All = sharedWrites(L);
  return All.TooMany ||
         (!All.Narrowed && !Shared.isNarrowed(At, variableAt(Pointer, L)));
}

SmallVector<Instruction *, 8> VisibleWrites::writesOf(const Location &L,
                                                      const Instruction &At,
                                                      const Value *Pointer) {
  if (isLocalOf(L, At)) {
    Writes All = allWrites(L);
    Locals.keepReaching(At, L, All);
    All.remove_if([&](Instruction *Write) {
      return Write->getFunction() != At.getFunction() &&
             !Shared.reaches(*Write, writtenBy(*Write, L), At,
                             Reaching::anywhereIn(*L.Root));
    });
    return All.takeVector();
  }
  if (Messages.has(Pointer))
    return {};
  const SharedWrites &All = sharedWrites(L);
  if (All.TooMany)
    return All.Own;
  Writes Out;
  std::optional<Reaching::Variable> Read = variableAt(Pointer, L);
  for (Instruction *Write : All.Own)
    if (Shared.reaches(*Write, writtenBy(*Write, L), At, Read))
      Out.insert(Write);
  Out.insert(All.Copied.begin(), All.Copied.end());
  return Out.takeVector();
}

ArrayRef<Instruction *> VisibleWrites::definitionsOf(const LoadInst &Load) {
  // While a caller iterates over the list, it may ask for other definitions.
  if (auto It = Definitions.find(&Load); It != Definitions.end())
    return *It->second;
  const Locations Touched = Pointers.touched(Load);
  SmallVector<Instruction *, 8> Found;
  if (Touched.size() == 1) {
    Found = writesOf(Touched.front(), Load, placeOf(Load));
  } else {
    Writes All;
    for (const Location &L : Touched)
      for (Instruction *Write : writesOf(L, Load, placeOf(Load)))
        All.insert(Write);
    Found = All.takeVector();
  }
  auto &Known = Definitions[&Load];
  Known = std::make_unique<SmallVector<Instruction *, 8>>(std::move(Found));
  return *Known;
}

SmallVector<LoadInst *, 8> VisibleWrites::usesOf(const Instruction &Write,
                                                 const Value *Pointer) {
  SmallSetVector<LoadInst *, 8> All;
  for (const Location &L : isa<StoreInst>(Write)
                               ? Pointers.touched(Write)
                               : Pointers.resolve(Pointer, true)) {
    auto [Own, Copied] = Accesses.readsOf(L);
    std::optional<Reaching::Variable> Written =
        variableAt(isa<StoreInst>(Write) ? placeOf(Write) : Pointer, L);
    Own.remove_if([&](LoadInst *Load) {
      // Also if it is read through a reference, which may lead to another
      // variable.
      if (isLocalOf(L, *Load))
        return !is_contained(definitionsOf(*Load), &Write);
      return !Shared.reaches(Write, Written, *Load,
                             variableAt(placeOf(*Load), L));
    });
    All.insert(Own.begin(), Own.end());
    All.insert(Copied.begin(), Copied.end());
  }
  All.remove_if([&](LoadInst *Load) {
    const Value *From = Load->getPointerOperand();
    return (isa<AllocaInst>(getUnderlyingObject(From)) || Messages.has(From)) &&
           !is_contained(definitionsOf(*Load), &Write);
  });
  return All.takeVector();
}

SmallVector<LoadInst *, 8>
VisibleWrites::elementsFrom(const Instruction *Write,
                            const Locations &Elements) {
  SmallSetVector<LoadInst *, 8> All;
  for (const Location &L : Elements) {
    auto [Own, Copied] = Accesses.readsOf(L);
    All.insert(Own.begin(), Own.end());
    All.insert(Copied.begin(), Copied.end());
  }
  All.remove_if([&](LoadInst *Load) {
    return Load->getType()->isPointerTy() ||
           (Write && !is_contained(definitionsOf(*Load), Write));
  });
  return All.takeVector();
}

//===----------------------------------------------------------------------===//
// Whole objects
//===----------------------------------------------------------------------===//

/// The parts of the object at \p L, which \p At gets by \p Pointer, that
/// \p At's function replaces.
SmallVector<VisibleWrites::Part, 4>
VisibleWrites::replacedParts(const Location &L, const Instruction &At,
                             const Value *Pointer) {
  SmallVector<Part, 4> Parts;
  std::optional<Reaching::Variable> Object = Shared.variableAt(Pointer, 1);
  if (!Object)
    return Parts;
  for (const Instruction *Write :
       Shared.replacingFrom(*At.getFunction(), Object->Where.first)) {
    const Location *Whole = Accesses.replacedBy(*Write);
    // What a call replaces is either listed here or not known.
    if (!Whole && !isa<StoreInst>(Write))
      continue;
    const Locations Own = Whole ? Locations{*Whole} : Pointers.touched(*Write);
    if (auto Way =
            Own.size() == 1 ? Alias.partOf(L, Own.front()) : std::nullopt;
        Way && !Way->empty())
      Parts.push_back({std::move(*Way), *Shared.replacedBy(*Write)});
  }
  return Parts;
}

SmallVector<Instruction *, 8> VisibleWrites::writesInto(const Location &L,
                                                        const Instruction &At,
                                                        const Value *Pointer) {
  Writes Out;
  if (Messages.has(Pointer))
    return {};
  bool Local = isLocalOf(L, At) && !Alias.isReachable(L);
  LocationMap<Writes> Gone;
  const SmallVector<Part, 4> Parts = replacedParts(L, At, Pointer);
  // For each part, the last write before \p At counts.
  auto Stays = [&](const Instruction &Write, const Location &Where) {
    if (!Local || Write.getFunction() != At.getFunction()) {
      auto Way = Alias.partOf(L, Where);
      auto *It = find_if(Parts, [&](const Part &P) {
        return Way && StepPath::areSame(P.Way, *Way);
      });
      std::optional<Reaching::Variable> Read;
      if (It != Parts.end())
        Read = It->Variable;
      else if (isLocalOf(L, At))
        Read = Reaching::anywhereIn(*L.Root);
      return Shared.reaches(Write, writtenBy(Write, Where), At, Read);
    }
    auto [It, New] = Gone.try_emplace(Where);
    if (New) {
      Writes All = allWrites(Where), Reaching = All;
      Locals.keepReaching(At, Where, Reaching);
      All.remove_if([&](Instruction *W) { return Reaching.contains(W); });
      It->second = std::move(All);
    }
    return !It->second.contains(const_cast<Instruction *>(&Write));
  };
  for (const Access *Part : Accesses.partsOf(L))
    if (Part->I != &At && Stays(*Part->I, Part->Where))
      Out.insert(Part->I);
  return Out.takeVector();
}

PreservedAnalyses VisibleWritesPrinter::run(Module &M,
                                            ModuleAnalysisManager &AM) {
  VisibleWrites &R = AM.getResult<VisibleWritesAnalysis>(M);
  OS << "visible writes of " << M.getName() << '\n';
  for (const Function &F : definedFunctions(M))
    for (const Instruction &I : instructions(F)) {
      const auto *Load = dyn_cast<LoadInst>(&I);
      if (!Load)
        continue;
      OS << "  ";
      Load->printAsOperand(OS, false);
      OS << " in " << F.getName() << place(I) << '\n';
      for (const Instruction *Write : R.definitionsOf(*Load))
        OS << "    " << *Write << " in " << Write->getFunction()->getName()
           << place(*Write) << '\n';
    }
  return PreservedAnalyses::all();
}

} // namespace tpc
