//===- ClassObjectAccess.cpp - Who reads and writes a location ------------===//
#include "memory/ClassObjectAccess.h"

using namespace llvm;

namespace tpc {

/// Variables that a value is followed to by copies of whole objects.
static constexpr unsigned MaxCopied = 16;

/// \p L and the variables that copies of whole objects put its value into, or
/// with \p Backward took it from.
Locations AccessResult::throughCopies(const Location &L, bool Backward) const {
  Locations All{L};
  const ObjectIndex &In = Backward ? CopiesTo : CopiesFrom;
  for (unsigned Next = 0; Next < All.size() && All.size() < MaxCopied; ++Next) {
    const Location Here = All[Next];
    auto Follow = [&](unsigned N) {
      const Copy &C = Copies[N];
      if (All.size() >= MaxCopied)
        return;
      for (const Location &Object : Backward ? C.To : C.From)
        if (auto Rest = Alias.partOf(Object, Here))
          for (Location Other : Backward ? C.From : C.To) {
            Types.extend(Other, *Rest);
            if (All.size() < MaxCopied && none_of(All, [&](const Location &K) {
                  return K.isSame(Other);
                }))
              All.push_back(std::move(Other));
          }
    };
    In.eachAround(Here, Follow);
  }
  return All;
}

SmallVector<Instruction *, 4> AccessResult::copiesTo(const Location &L) const {
  SmallSetVector<Instruction *, 4> Found;
  for (const Location &Here : throughCopies(L, /*Backward=*/true)) {
    CopiesTo.eachAround(Here, [&](unsigned N) {
      if (any_of(Copies[N].To, [&](const Location &Object) {
            return Alias.partOf(Object, Here).has_value();
          }))
        Found.insert(Copies[N].I);
    });
  }
  return {Found.begin(), Found.end()};
}

bool AccessResult::reaches(const Location &From, const Location &To) const {
  return any_of(throughCopies(From, /*Backward=*/false),
                [&](const Location &Here) { return Alias.mayBe(Here, To); });
}

/// The writes of \p L: its own, and those that copies of whole objects bring.
void AccessResult::collectWrites(const Location &L, Writes &Own,
                                 Writes &Copied) const {
  const Locations All = throughCopies(L, /*Backward=*/true);
  for (const Location &Here : All) {
    // Several fields that are read as one, in a register: any of them.
    if (isa_and_nonnull<StructType>(elementOf(Types.typeAt(Here))))
      for (Instruction *Write : writesInto(Here))
        if (isa<StoreInst>(Write))
          Copied.insert(Write);
    Writes &Out = &Here == All.begin() ? Own : Copied;
    StoreIndex.eachAt(Here, [&](unsigned N) {
      if (Alias.mayBe(Stores[N].Where, Here))
        Out.insert(Stores[N].I);
    });
    HandedIndex.eachAround(Here, [&](unsigned N) {
      if (Alias.partOf(Handed[N].Where, Here))
        Out.insert(Handed[N].I);
    });
  }
}

AccessResult::Writes AccessResult::allWrites(const Location &L) const {
  Writes Own, Copied;
  collectWrites(L, Own, Copied);
  Own.insert(Copied.begin(), Copied.end());
  return Own;
}

/// The loads of \p L: its own, and those of what it is copied into.
void AccessResult::collectLoads(const Location &L,
                                SmallSetVector<LoadInst *, 8> &Own,
                                SmallSetVector<LoadInst *, 8> &Copied) const {
  const Locations All = throughCopies(L, /*Backward=*/false);
  for (const Location &Here : All)
    LoadIndex.eachAt(Here, [&](unsigned N) {
      if (Alias.mayBe(Loads[N].Where, Here))
        (&Here == All.begin() ? Own : Copied)
            .insert(cast<LoadInst>(Loads[N].I));
    });
}

SmallVector<Instruction *, 8>
AccessResult::writesInto(const Location &L) const {
  Writes Out;
  for (unsigned N : partsOf(L))
    Out.insert(PartWrites[N].I);
  return Out.takeVector();
}

/// The numbers of the writes of what is in the object at \p L.
SmallVector<unsigned, 16> AccessResult::partsOf(const Location &L) const {
  SmallSetVector<unsigned, 16> Numbers;
  WritesByObject.eachIn(L, [&](unsigned N) {
    if (Alias.partOf(L, PartWrites[N].Where))
      Numbers.insert(N);
  });
  SmallVector<unsigned, 16> Ordered = Numbers.takeVector();
  sort(Ordered);
  return Ordered;
}

} // namespace tpc
