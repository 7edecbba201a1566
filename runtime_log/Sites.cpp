//===- Sites.cpp ----------------------------------------------------------===//
#include "Sites.h"

#include "Light.h"
#include "ReadNames.h"
#include "Runtime.h"

#include <algorithm>
#include <new>
#include <utility>

namespace tpc {

bool Meter::takes(uint64_t Cap, int64_t Ns) {
  if (!Cap)
    return true;
  auto Second = static_cast<uint64_t>(Ns / 1'000'000'000) & 0xFFFFFFFFU;
  uint64_t Seen = Used.load(std::memory_order_relaxed);
  for (;;) {
    bool IsSame = Seen >> 32 == Second;
    uint64_t Count = IsSame ? Seen & 0xFFFFFFFFU : 0;
    if (Count >= Cap)
      return false;
    if (Used.compare_exchange_weak(Seen, Second << 32 | (Count + 1),
                                   std::memory_order_relaxed))
      return true;
  }
}

bool FairMeter::takes(uint64_t Cap, int64_t Ns, Share &Of) {
  if (!Cap)
    return true;
  constexpr int64_t Kept = 10'000'000'000, Eighth = Kept / 8;
  constexpr uint64_t MostHad = 3, Bits = 8;
  const auto Round = static_cast<uint64_t>(Ns / Kept) + 1;
  const uint64_t Before = Of.Had.load(std::memory_order_relaxed);
  const uint64_t Had = Before >> Bits == Round ? Before & 0xFF : 0;
  const auto Spared = Before ? Eighth * static_cast<int64_t>(Had + 1) : 0;
  const auto Each = static_cast<int64_t>(
      1'000'000'000 / std::min<uint64_t>(Cap, 1'000'000'000));
  int64_t Seen = FullAt.load(std::memory_order_relaxed), Next;
  do {
    // A clock that was ahead for a moment must not keep all others waiting.
    Next = std::clamp(Seen, Ns, Ns + Kept) + Each;
    if (Next - Ns > Kept - Spared)
      return false;
  } while (
      !FullAt.compare_exchange_weak(Seen, Next, std::memory_order_relaxed));
  Of.Had.store(Round << Bits | std::min(Had + 1, MostHad),
               std::memory_order_relaxed);
  return true;
}

Site::Site(std::string Text, size_t Length, uint32_t Number)
    : Number(Number), IsShort(Length < sizeof(Head)), Key(std::move(Text)),
      Length(Length) {
  if (!IsShort)
    std::memcpy(Head, Key.data(), sizeof(Head));
}

Site *Sites::create(std::string Text, size_t Length) {
  uint32_t Count = Size.load(std::memory_order_relaxed);
  if (Count == Most)
    return nullptr;
  auto *S = new Site(std::move(Text), Length, Count + 1);
  std::atomic<Site **> &Block = Blocks[Count / BlockSize];
  if (!Block.load(std::memory_order_relaxed))
    Block.store(new Site *[BlockSize](), std::memory_order_release);
  Block.load(std::memory_order_relaxed)[Count % BlockSize] = S;
  Size.store(Count + 1, std::memory_order_release);
  ByText.emplace(S->Key, S);
  return S;
}

Site *Sites::ofText(const char *Key) {
  if (auto Known = ByText.find(Key); Known != ByText.end())
    return Known->second;
  return create(Key, std::strlen(Key));
}

/// The site of \p Object under the key of \p First. If it shares one, \p Object
/// becomes what stands for all of those.
Site *Sites::ofObject(Site &First, const void *&Object) {
  for (auto &[Known, S] : First.Instances)
    if (Known == Object)
      return S;
  size_t Number = First.Instances.size() + 1;
  if (Number > MostInstances) {
    Object = &Others;
    Number = 0;
  }
  std::string Text = First.Key + "#" + std::to_string(Number);
  Site *S = Number == 1 ? &First : nullptr;
  if (auto Known = ByText.find(Text); !S && Known != ByText.end())
    S = Known->second;
  if (!S)
    S = create(std::move(Text), First.Length);
  if (S && Number)
    First.Instances.emplace_back(Object, S);
  return S;
}

Site *Sites::ofOthers(const char *Key) const { return at(Key, &Others); }

Site *Sites::make(const char *Key, const void *Object) {
  Site *S;
  bool IsShared = false, Warns = false;
  {
    std::lock_guard<std::mutex> Guard(Making);
    S = ofText(Key);
    const void *Own = Object;
    if (S && Object)
      S = ofObject(*S, Own);
    if (!S)
      return nullptr;
    IsShared = Own != Object;
    Warns = IsShared && !std::exchange(HasTold, true);
    bind(Key, Own, *S);
  }
  if (Warns)
    warn("more than " + std::to_string(MostInstances) +
         " objects evaluate comparison " + Key + "; the others share " + Key +
         "#0, and so for every comparison");
  if (Object && !IsShared)
    ReadNames::all().addObject(*S, Object);
  return S;
}

void Sites::bind(const char *Key, const void *Object, Site &S) {
  Table *T = Current.load(std::memory_order_relaxed);
  auto Put = [](Table &In, const char *Address, const void *Of, Site *Found) {
    for (uint64_t I = hash(Address, Of);; ++I) {
      Entry &E = In.Entries[I & In.Mask];
      const char *There = E.Key.load(std::memory_order_relaxed);
      if (There && (There != Address || E.Object != Of))
        continue;
      if (!There)
        E.Object = Of;
      E.Found.store(Found, std::memory_order_release);
      E.Key.store(Address, std::memory_order_release);
      return There == nullptr;
    }
  };
  if (!T || (Bound + 1) * 2 > T->Mask + 1) {
    // A reader may still use the old table, so it is kept. All old tables
    // together are smaller than the new one.
    uint64_t Entries = T ? (T->Mask + 1) * 2 : 1024;
    auto *Larger = new Table{Entries - 1, new Entry[Entries]};
    for (uint64_t I = 0; T && I <= T->Mask; ++I)
      if (const Entry &E = T->Entries[I]; const char *Address = E.Key.load())
        Put(*Larger, Address, E.Object, E.Found.load());
    Current.store(Larger, std::memory_order_release);
    T = Larger;
  }
  Bound += Put(*T, Key, Object, &S);
}

void Sites::forget(uintptr_t Begin, uintptr_t End) {
  // No key begins with zeros, so that nothing is found at its place.
  static auto &Nobody =
      *new Site(std::string(sizeof(Site::Head), '\0'), sizeof(Site::Head), 0);
  const auto IsIn = [&](const void *Object) {
    const auto Address = reinterpret_cast<uintptr_t>(Object);
    return Begin <= Address && Address < End;
  };
  std::vector<Site *> Gone;
  {
    std::lock_guard<std::mutex> Guard(Making);
    for (uint32_t Number = 1; Number <= size(); ++Number)
      for (auto &[Object, S] : (*this)[Number].Instances)
        if (IsIn(Object)) {
          // Its number stays taken.
          Object = nullptr;
          Gone.push_back(S);
        }
    if (const Table *T = Current.load(std::memory_order_relaxed))
      for (uint64_t I = 0; I <= T->Mask; ++I)
        if (Entry &E = T->Entries[I]; E.Key.load() && IsIn(E.Object))
          E.Found.store(&Nobody, std::memory_order_release);
  }
  for (Site *S : Gone)
    releaseWords(*S);
}

void Sites::afterFork() {
  for (uint32_t Number = 1; Number <= size(); ++Number)
    new (&(*this)[Number].Lock) std::mutex;
}

} // namespace tpc
