//===- AccessIndex.cpp ----------------------------------------------------===//
#include "memory/AccessIndex.h"

#include "llvm/Support/CommandLine.h"

#include "memory/AccessBuilder.h"
#include "support/Print.h"

using namespace llvm;

namespace tpc {

AnalysisKey ClassObjectAccess::Key;

/// Messages are copied from queue to queue, and each copy is searched for
/// accesses.
static cl::opt<unsigned> MaxCopied(
    "tpc-max-object-copies", cl::Hidden, cl::init(16),
    cl::desc(
        "Variables that a value is followed to by copies of whole objects"));

/// A getter that returns an object by value makes a copy in each caller.
static cl::opt<unsigned> MaxCopiedLocals(
    "tpc-max-local-copies", cl::Hidden, cl::init(256),
    cl::desc("The same, with locals that the limit does not count"));

/// True if \p L is found by its class, and the variables \p Found, without a
/// root, do not stand for it yet.
bool AccessIndex::isSearchedByClass(const Location &L,
                                    const Locations &Found) const {
  ArrayRef<Step> Path = L.Path;
  return Alias.isReachable(L) && none_of(Found, [&](const Location &K) {
           return !K.Root && !K.Path.empty() && K.Path.size() <= Path.size() &&
                  StepPath::areSame(Path.take_back(K.Path.size()), K.Path);
         });
}

/// \p L and the variables to which copies of whole objects bring its value or,
/// with \p Backward, from which they take it. A variable that is found by its
/// class stands for all names of it: `Node::limits` for those in the objects
/// and lists that contain a Node. The limit does not count locals that no other
/// function finds by their class: few accesses are theirs.
const AccessIndex::Connected &AccessIndex::throughCopies(const Location &L,
                                                         bool Backward) {
  auto [It, New] = (Backward ? this->Backward : Forward).try_emplace(L);
  Locations &All = It->second.All;
  bool &IsCut = It->second.IsCut;
  if (!New)
    return It->second;
  unsigned Counted = 0;
  auto Add = [&](Location Other) {
    bool Counts = isSearchedByClass(Other, All);
    if (any_of(All, [&](const Location &K) { return K.isSame(Other); }) ||
        (!Counts && Alias.isReachable(Other)))
      return;
    Counted += Counts;
    All.push_back(std::move(Other));
    IsCut = Counted >= MaxCopied || All.size() >= MaxCopiedLocals;
  };
  Add(L);
  const ObjectIndex &In = Backward ? TargetIndex : SourceIndex;
  ArrayRef<CopyEnd> Ends = Backward ? Targets : Sources;
  for (unsigned Next = 0; Next < All.size() && !IsCut; ++Next) {
    const Location Here = All[Next];
    In.eachAround(Here, [&](unsigned N) {
      if (IsCut)
        return;
      auto Rest = Alias.partOf(Ends[N].Object, Here);
      if (!Rest)
        return;
      const Copy &C = Copies[Ends[N].Copy];
      for (Location Other : Backward ? C.From : C.To) {
        Types.extend(Other, *Rest);
        if (!IsCut)
          Add(std::move(Other));
      }
    });
  }
  return It->second;
}

SmallVector<Instruction *, 4> AccessIndex::copiesTo(const Location &L,
                                                    DenseSet<unsigned> &Known) {
  SmallSetVector<Instruction *, 4> Found;
  auto Add = [&](unsigned N) { Found.insert(Copies[Targets[N].Copy].I); };
  for (const Location &Here : throughCopies(L, /*Backward=*/true).All) {
    TargetIndex.eachOnPath(Here, [&](unsigned N) {
      if (Alias.partOf(Targets[N].Object, Here))
        Add(N);
    });
    if (auto Class = ObjectIndex::classAround(Here);
        Class && Known.insert(*Class).second)
      TargetIndex.eachWith(*Class, Add);
  }
  return Found.takeVector();
}

bool AccessIndex::reaches(const Location &From, const Location &To) {
  return any_of(throughCopies(From, /*Backward=*/false).All,
                [&](const Location &Here) { return Alias.mayBe(Here, To); });
}

AccessIndex::Found<AccessIndex::Writes>
AccessIndex::writesOf(const Location &L) {
  Found<Writes> Out;
  const Locations &All = throughCopies(L, /*Backward=*/true).All;
  for (const Location &Here : All) {
    // Several fields that are read together in a register: any of them.
    if (isa_and_nonnull<StructType>(elementOf(Types.typeAt(Here))))
      for (Instruction *Write : writesInto(Here))
        if (isa<StoreInst>(Write))
          Out.Copied.insert(Write);
    Writes &To = &Here == All.begin() ? Out.Own : Out.Copied;
    StoreIndex.eachAt(Here, [&](unsigned N) {
      if (Alias.mayBe(Stores[N].Where, Here))
        To.insert(Stores[N].I);
    });
    HandedIndex.eachAround(Here, [&](unsigned N) {
      if (Alias.partOf(Handed[N].Where, Here))
        To.insert(Handed[N].I);
    });
  }
  return Out;
}

AccessIndex::Found<AccessIndex::Reads> AccessIndex::readsOf(const Location &L) {
  Found<Reads> Out;
  const Locations &All = throughCopies(L, /*Backward=*/false).All;
  for (const Location &Here : All) {
    Reads &To = &Here == All.begin() ? Out.Own : Out.Copied;
    LoadIndex.eachAt(Here, [&](unsigned N) {
      if (Alias.mayBe(Loads[N].Where, Here))
        To.insert(cast<LoadInst>(Loads[N].I));
    });
  }
  return Out;
}

SmallVector<StoreInst *, 8> AccessIndex::storesAt(const Location &L) const {
  SmallSetVector<StoreInst *, 8> At;
  StoreIndex.eachAt(L, [&](unsigned N) {
    if (Alias.mayBe(Stores[N].Where, L))
      At.insert(cast<StoreInst>(Stores[N].I));
  });
  return At.takeVector();
}

SmallVector<LoadInst *, 8> AccessIndex::loadsAt(const Location &L) const {
  Reads At;
  LoadIndex.eachAt(L, [&](unsigned N) {
    if (Alias.mayBe(Loads[N].Where, L))
      At.insert(cast<LoadInst>(Loads[N].I));
  });
  return At.takeVector();
}

ArrayRef<const Access *> AccessIndex::partsOf(const Location &Object) {
  auto [It, New] = Parts.try_emplace(Object);
  if (!New)
    return It->second;
  SmallSetVector<unsigned, 16> Numbers;
  WritesByObject.eachIn(Object, [&](unsigned N) {
    if (Alias.partOf(Object, PartWrites[N].Where))
      Numbers.insert(N);
  });
  SmallVector<unsigned, 16> Ordered = Numbers.takeVector();
  sort(Ordered);
  for (unsigned N : Ordered)
    It->second.push_back(&PartWrites[N]);
  return It->second;
}

SmallVector<Instruction *, 8> AccessIndex::writesInto(const Location &L) {
  Writes Out;
  for (const Access *Part : partsOf(L))
    Out.insert(Part->I);
  return Out.takeVector();
}

const Location *AccessIndex::replacedBy(const Instruction &Call) const {
  auto It = Replaced.find(&Call);
  return It == Replaced.end() ? nullptr : &It->second;
}

AccessIndex ClassObjectAccess::run(Module &M, ModuleAnalysisManager &AM) {
  AccessIndex R(AM.getResult<AliasesAnalysis>(M),
                AM.getResult<LocationTypesAnalysis>(M));
  AccessBuilder(R, AM.getResult<PointsToAnalysis>(M),
                AM.getResult<SimpleCallGraph>(M), AM.getResult<RuleAnalysis>(M),
                M)
      .fileAccesses();
  return R;
}

PreservedAnalyses ClassObjectAccessPrinter::run(Module &M,
                                                ModuleAnalysisManager &AM) {
  const AccessIndex &R = AM.getResult<ClassObjectAccess>(M);
  const LocationTypes &Types = AM.getResult<LocationTypesAnalysis>(M);
  OS << "accesses of " << M.getName() << '\n';
  auto Print = [&](const char *What, ArrayRef<Access> List) {
    for (const Access &A : List) {
      OS << "  " << What << ' ';
      Types.print(OS, A.Where);
      OS << " in " << A.I->getFunction()->getName() << place(*A.I) << '\n';
    }
  };
  Print("load", R.loads());
  Print("store", R.stores());
  return PreservedAnalyses::all();
}

} // namespace tpc
