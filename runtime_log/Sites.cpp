//===- Sites.cpp ----------------------------------------------------------===//
#include "Sites.h"

#include <new>

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

Site::Site(std::string Text, uint32_t Number)
    : Number(Number), IsShort(Text.size() < sizeof(Head)),
      Key(std::move(Text)) {
  if (!IsShort)
    std::memcpy(Head, Key.data(), sizeof(Head));
}

Site *Sites::ofText(const char *Key) {
  if (auto Known = ByText.find(Key); Known != ByText.end())
    return Known->second;
  uint32_t Count = Size.load(std::memory_order_relaxed);
  if (Count == Most)
    return nullptr;
  auto *S = new Site(Key, Count + 1);
  std::atomic<Site **> &Block = Blocks[Count / BlockSize];
  if (!Block.load(std::memory_order_relaxed))
    Block.store(new Site *[BlockSize](), std::memory_order_release);
  Block.load(std::memory_order_relaxed)[Count % BlockSize] = S;
  Size.store(Count + 1, std::memory_order_release);
  ByText.emplace(S->Key, S);
  return S;
}

Site *Sites::make(const char *Key) {
  std::lock_guard<std::mutex> Guard(Making);
  Site *S = ofText(Key);
  if (S)
    bind(Key, *S);
  return S;
}

void Sites::bind(const char *Key, Site &S) {
  Table *T = Current.load(std::memory_order_relaxed);
  auto Put = [](Table &In, const char *Address, Site *Found) {
    for (uint64_t I = hash(Address);; ++I) {
      Entry &E = In.Entries[I & In.Mask];
      const char *There = E.Key.load(std::memory_order_relaxed);
      if (There && There != Address)
        continue;
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
      if (const char *Address = T->Entries[I].Key.load())
        Put(*Larger, Address, T->Entries[I].Found.load());
    Current.store(Larger, std::memory_order_release);
    T = Larger;
  }
  Bound += Put(*T, Key, &S);
}

void Sites::afterFork() {
  for (uint32_t Number = 1; Number <= size(); ++Number)
    new (&(*this)[Number].Lock) std::mutex;
}

} // namespace tpc
