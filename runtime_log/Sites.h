//===- Sites.h - The comparisons of this process --------------------------===//
#ifndef TPC_SITES_H
#define TPC_SITES_H

#include <atomic>
#include <cstdint>
#include <cstring>
#include <mutex>
#include <string>
#include <string_view>
#include <unordered_map>

namespace tpc {

class LogFile;
struct LightSite;

/// Counts the reports of the current second against a cap.
class Meter {
public:
  /// Whether one more report in the second of \p Ns stays within \p Cap (0: no
  /// cap).
  bool takes(uint64_t Cap, int64_t Ns);

private:
  /// The second in the upper half, the number of reports in it in the lower
  /// half.
  std::atomic<uint64_t> Used{0};
};

/// What was dropped since it was last reported.
struct DropCount {
  std::atomic<uint64_t> Count{0};
  std::atomic<uint64_t> Flops{0};
};

/// One key. Sites are never destroyed.
struct Site {
  Site(std::string Text, uint32_t Number);

  /// Whether the key that was found at \p Address is still there.
  bool isAt(const char *Address) const {
    if (__builtin_expect(IsShort, 0))
      return Key == Address;
    uint64_t There[2];
    std::memcpy(There, Address, sizeof(There));
    return There[0] == Head[0] && There[1] == Head[1];
  }

  uint64_t Head[2] = {0, 0}; ///< the first 16 bytes of the key
  /// The file that contains the key under its number.
  std::atomic<const LogFile *> WrittenTo{nullptr};
  const uint32_t Number; ///< from 1
  const bool IsShort;    ///< the key has fewer than 16 bytes
  /// The last outcome of the predicate: -1 before the first evaluation.
  std::atomic<int8_t> Last{-1};
  const std::string Key;
  std::mutex Lock; ///< held while Last changes
  Meter Used;
  DropCount OverSiteCap, OverProcessCap;
  /// What a store of reports gave up to make space, and the last result that it
  /// gave up. The store's lock is held while they change.
  DropCount Evicted;
  int8_t LastEvicted = -1;
  /// What the policy `light` knows about it.
  std::atomic<LightSite *> Light{nullptr};
};

/// Finds sites by the address of the key, or by its text if the address is new.
/// Finding takes no lock, creating does.
class Sites {
public:
  static constexpr uint32_t Most = 1U << 22;

  /// The site of \p Key, created if it is new; null beyond Most sites.
  Site *find(const char *Key) {
    Site *S = known(Key);
    return S ? S : make(Key);
  }

  /// The site of \p Key if it was found at this address before; otherwise null.
  Site *known(const char *Key) const {
    if (const Table *T = Current.load(std::memory_order_acquire))
      for (uint64_t I = hash(Key);; ++I) {
        const Entry &E = T->Entries[I & T->Mask];
        const char *There = E.Key.load(std::memory_order_acquire);
        if (There == Key) {
          // After a library is unloaded, another may be loaded at its address.
          Site *S = E.Found.load(std::memory_order_acquire);
          if (__builtin_expect(S->isAt(Key), 1))
            return S;
          break;
        }
        if (!There)
          break;
      }
    return nullptr;
  }

  Site &operator[](uint32_t Number) const {
    return *Blocks[(Number - 1) / BlockSize].load(
        std::memory_order_acquire)[(Number - 1) % BlockSize];
  }

  /// The number of sites; their numbers begin with 1.
  uint32_t size() const { return Size.load(std::memory_order_acquire); }

  /// Call before and after a fork.
  void lock() { Making.lock(); }
  void unlock() { Making.unlock(); }
  /// Call in the child: releases what other threads held.
  void afterFork();

private:
  static constexpr uint32_t BlockSize = 1024;

  struct Entry {
    std::atomic<const char *> Key{nullptr};
    std::atomic<Site *> Found{nullptr};
  };
  struct Table {
    uint64_t Mask;
    Entry *Entries;
  };

  static uint64_t hash(const char *Key) {
    return (reinterpret_cast<uintptr_t>(Key) * 0x9E3779B97F4A7C15U) >> 32;
  }

  Site *make(const char *Key);
  Site *ofText(const char *Key);
  void bind(const char *Key, Site &S);

  std::atomic<Table *> Current{nullptr};
  uint64_t Bound = 0; ///< entries of the table in use
  std::mutex Making;
  std::unordered_map<std::string_view, Site *> ByText;
  std::atomic<Site **> Blocks[Most / BlockSize] = {};
  std::atomic<uint32_t> Size{0};
};

} // namespace tpc

#endif // TPC_SITES_H
