//===- ClassObjectAccess.cpp - Who reads and writes a location ------------===//
#include "memory/ClassObjectAccess.h"

using namespace llvm;

namespace tpc {

/// Variables that a value is followed to by copies of whole objects.
static constexpr unsigned MaxCopied = 16;

AccessResult::Slot AccessResult::slot(const Location &L) {
  if (L.Path.empty())
    return {L.Root, ~0U};
  return {reinterpret_cast<const void *>(
              static_cast<uintptr_t>(L.Path.back().Type) * 16 + 8),
          L.Path.back().Index};
}

/// True where a pointer without a known root can lead to \p L.
bool AccessResult::isReachable(const Location &L) const {
  return !L.Root || !isa<AllocaInst>(L.Root) || Escaped.contains(L.Root);
}

void AccessResult::file(Index &In, unsigned N, const Location &L) const {
  In.Exact[{slot(L), L.Root}].push_back(N);
  if (L.Root && !L.Path.empty() && isReachable(L))
    In.Rooted[slot(L)].push_back(N);
}

/// The numbers of the classes that are in an object of type \p T.
static void classesIn(Type *T, TypeNumbers &Numbers,
                      SmallSetVector<unsigned, 8> &Out) {
  auto *Class = dyn_cast_or_null<StructType>(elementOf(T));
  if (!Class || Class->isOpaque() || !Out.insert(Numbers.numberOf(Class)))
    return;
  for (Type *Field : Class->elements())
    classesIn(Field, Numbers, Out);
}

void AccessResult::fileObject(ObjectIndex &In, unsigned N,
                              const Location &Object) const {
  file(In.BySlot, N, Object);
  if (!isReachable(Object))
    return;
  SmallSetVector<unsigned, 8> Classes;
  classesIn(typeAt(Object), Numbers, Classes);
  for (unsigned Class : Classes)
    In.ByClass[Class].push_back(N);
}

void AccessResult::filePart(PartIndex &In, unsigned N,
                            const Location &L) const {
  if (L.Root)
    file(In.BySlot, N, {L.Root, {}});
  for (size_t K = 1; K <= L.Path.size(); ++K)
    file(In.BySlot, N,
         {L.Root, SmallVector<Step, 4>(ArrayRef(L.Path).take_front(K))});
  if (!L.Root && !L.Path.empty())
    In.ByClass[L.Path[0].Type].push_back(N);
}

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
        if (auto Rest = partOf(Object, Here))
          for (Location Other : Backward ? C.From : C.To) {
            extend(Other, *Rest);
            if (All.size() < MaxCopied && none_of(All, [&](const Location &K) {
                  return K.isSame(Other);
                }))
              All.push_back(std::move(Other));
          }
    };
    eachAround(Here, In.BySlot, Follow);
    if (!Here.Root && !Here.Path.empty())
      if (auto It = In.ByClass.find(Here.Path[0].Type); It != In.ByClass.end())
        for_each(It->second, Follow);
  }
  return All;
}

SmallVector<Instruction *, 4> AccessResult::copiesTo(const Location &L) const {
  SmallSetVector<Instruction *, 4> Found;
  for (const Location &Here : throughCopies(L, /*Backward=*/true)) {
    auto Add = [&](unsigned N) {
      if (any_of(Copies[N].To, [&](const Location &Object) {
            return partOf(Object, Here).has_value();
          }))
        Found.insert(Copies[N].I);
    };
    eachAround(Here, CopiesTo.BySlot, Add);
    if (Here.Root || Here.Path.empty())
      continue;
    if (auto It = CopiesTo.ByClass.find(Here.Path[0].Type);
        It != CopiesTo.ByClass.end())
      for_each(It->second, Add);
  }
  return {Found.begin(), Found.end()};
}

bool AccessResult::reaches(const Location &From, const Location &To) const {
  return any_of(throughCopies(From, /*Backward=*/false),
                [&](const Location &Here) { return mayBe(Here, To); });
}

/// The writes of \p L: its own, and those that copies of whole objects bring.
void AccessResult::collectWrites(const Location &L, Writes &Own,
                                 Writes &Copied) const {
  const Locations All = throughCopies(L, /*Backward=*/true);
  for (const Location &Here : All) {
    // Several fields that are read as one, in a register: any of them.
    if (isa_and_nonnull<StructType>(elementOf(typeAt(Here))))
      for (Instruction *Write : writesInto(Here))
        if (isa<StoreInst>(Write))
          Copied.insert(Write);
    Writes &Out = &Here == All.begin() ? Own : Copied;
    eachAt(Here, StoreIndex, [&](unsigned N) {
      if (mayBe(Stores[N].Where, Here))
        Out.insert(Stores[N].I);
    });
    eachAround(Here, HandedIndex, [&](unsigned N) {
      if (partOf(Handed[N].Where, Here))
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
    eachAt(Here, LoadIndex, [&](unsigned N) {
      if (mayBe(Loads[N].Where, Here))
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
  auto Add = [&](unsigned N) {
    if (partOf(L, PartWrites[N].Where))
      Numbers.insert(N);
  };
  eachAt(L, WritesByObject.BySlot, Add);
  if (isReachable(L)) {
    SmallSetVector<unsigned, 8> Classes;
    classesIn(typeAt(L), this->Numbers, Classes);
    for (unsigned Class : Classes)
      if (auto It = WritesByObject.ByClass.find(Class);
          It != WritesByObject.ByClass.end())
        for_each(It->second, Add);
  }
  SmallVector<unsigned, 16> Ordered = Numbers.takeVector();
  sort(Ordered);
  return Ordered;
}

} // namespace tpc
