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
#include <vector>

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

/// Shares the reports of a process among its sites. What they leave of the cap
/// is kept, as much as comes in ten seconds. The more of that is used up, the
/// fewer reports a site may have had in the current ten seconds to get one
/// more; the last eighth is for sites that have not had any yet.
class FairMeter {
public:
  /// What one site has had.
  class Share {
    friend FairMeter;
    /// The round in the upper bits, the number of reports in it in the lower
    /// eight.
    std::atomic<uint64_t> Had{0};
  };

  /// Whether one more report at \p Ns, of the site of \p Of, stays within
  /// \p Cap a second (0: no cap).
  bool takes(uint64_t Cap, int64_t Ns, Share &Of);

private:
  /// When as much as possible will be kept, if nothing more is taken.
  std::atomic<int64_t> FullAt{0};
};

/// What was dropped since it was last reported.
struct DropCount {
  std::atomic<uint64_t> Count{0};
  std::atomic<uint64_t> Flops{0};
};

/// One key, or what one object evaluates under it. Sites are never destroyed.
struct Site {
  /// \p Length is that of the key in \p Text, without the number of an
  /// instance.
  Site(std::string Text, size_t Length, uint32_t Number);

  /// Whether the key that was found at \p Address is still there.
  bool isAt(const char *Address) const {
    if (__builtin_expect(IsShort, 0))
      return (!std::strncmp(Key.data(), Address, Length) && !Address[Length]) ||
             Key == Address;
    uint64_t There[2];
    std::memcpy(There, Address, sizeof(There));
    return There[0] == Head[0] && There[1] == Head[1];
  }

  uint64_t Head[2] = {0, 0}; ///< the first 16 bytes of the key
  /// The file that contains the key under its number.
  std::atomic<const LogFile *> WrittenTo{nullptr};
  /// The file of a ring in which its outcome was said, and what was last
  /// reported with it.
  std::atomic<const LogFile *> StatedIn{nullptr};
  struct {
    bool IsKnown, Result, Outcome;
    double Compared, Threshold;
  } Stated{};
  const uint32_t Number; ///< from 1
  const bool IsShort;    ///< the key has fewer than 16 bytes
  /// The last outcome of the predicate: -1 before the first evaluation.
  std::atomic<int8_t> Last{-1};
  const std::string Key; ///< as it is reported
  const size_t Length;   ///< of the key in it
  /// The objects that have evaluated the key, each with its site; the first one
  /// has this one. The lock of Sites is held while they are used.
  std::vector<std::pair<const void *, Site *>> Instances;
  std::mutex Lock; ///< held while Last changes
  Meter Used;
  FairMeter::Share OfProcess;
  DropCount OverSiteCap, OverProcessCap;
  /// What a store of reports gave up to make space, and the last result that it
  /// gave up. The store's lock is held while they change.
  DropCount Evicted;
  int8_t LastEvicted = -1;
  /// The node whose object it is of, if that is known and not the one that the
  /// process is named after. Never freed.
  std::atomic<const char *> Node{nullptr};
  /// What the policy `light` knows about it.
  std::atomic<LightSite *> Light{nullptr};
};

/// Finds sites by the address of the key and of the object, or by the key's
/// text if these are new. Finding takes no lock, creating does.
class Sites {
public:
  static constexpr uint32_t Most = 1U << 22;
  /// So many objects have a site of their own for a key; the others share one.
  static constexpr size_t MostInstances = 32;

  /// The site of \p Key and \p Object, created if it is new; null beyond Most
  /// sites.
  Site *find(const char *Key, const void *Object = nullptr) {
    Site *S = known(Key, Object);
    return S ? S : make(Key, Object);
  }

  /// The site of \p Key and \p Object if it was found before, with the key at
  /// this address; otherwise null.
  [[gnu::always_inline]] Site *known(const char *Key,
                                     const void *Object = nullptr) const {
    Site *S = at(Key, Object);
    return S || !Object ? S : ofOthers(Key);
  }

  Site &operator[](uint32_t Number) const {
    return *Blocks[(Number - 1) / BlockSize].load(
        std::memory_order_acquire)[(Number - 1) % BlockSize];
  }

  /// The number of sites; their numbers begin with 1.
  uint32_t size() const { return Size.load(std::memory_order_acquire); }

  /// The objects at these addresses are gone: others that are made there get
  /// sites of their own.
  void forget(uintptr_t Begin, uintptr_t End);

  /// Call before and after a fork.
  void lock() { Making.lock(); }
  void unlock() { Making.unlock(); }
  /// Call in the child: releases what other threads held.
  void afterFork();

private:
  static constexpr uint32_t BlockSize = 1024;

  /// Its size makes it cheap to find, and keeps it in one cache line.
  struct alignas(32) Entry {
    /// Set last, and once.
    std::atomic<const char *> Key{nullptr};
    const void *Object = nullptr;
    std::atomic<Site *> Found{nullptr};
  };
  struct Table {
    uint64_t Mask;
    Entry *Entries;
  };

  static uint64_t hash(const char *Key, const void *Object) {
    // Shifted, because objects are as far from each other as keys.
    auto Mixed = reinterpret_cast<uintptr_t>(Key) ^
                 reinterpret_cast<uintptr_t>(Object) << 20;
    return (Mixed * 0x9E3779B97F4A7C15U) >> 32;
  }

  [[gnu::always_inline]] Site *at(const char *Key, const void *Object) const {
    if (const Table *T = Current.load(std::memory_order_acquire))
      for (uint64_t I = hash(Key, Object);; ++I) {
        const Entry &E = T->Entries[I & T->Mask];
        const char *There = E.Key.load(std::memory_order_acquire);
        if (There == Key && E.Object == Object) {
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

  Site *ofOthers(const char *Key) const;
  Site *make(const char *Key, const void *Object);
  Site *create(std::string Text, size_t Length);
  Site *ofText(const char *Key);
  Site *ofObject(Site &First, const void *&Object);
  void bind(const char *Key, const void *Object, Site &S);

  /// Its address stands for the objects that have no site of their own.
  static constexpr char Others = 0;

  std::atomic<Table *> Current{nullptr};
  uint64_t Bound = 0;   ///< entries of the table in use
  bool HasTold = false; ///< that objects share their reports
  std::mutex Making;
  std::unordered_map<std::string_view, Site *> ByText;
  std::atomic<Site **> Blocks[Most / BlockSize] = {};
  std::atomic<uint32_t> Size{0};
};

} // namespace tpc

#endif // TPC_SITES_H
