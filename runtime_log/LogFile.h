//===- LogFile.h - The binary file of reports -----------------------------===//
//
// Records are written straight into the mapped file: the kernel keeps them
// whatever happens to the process. Space is allocated before it is mapped, so
// that a full disk is an error and no signal, and its pages are touched ahead
// by the helper thread, so that a report waits for none. Layout: Layout.h.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_LOGFILE_H
#define TPC_LOGFILE_H

#include "Clock.h"
#include "Config.h"
#include "Layout.h"
#include "Report.h"
#include "Sites.h"
#include "Threads.h"

#include <memory>
#include <string>
#include <sys/types.h>
#include <vector>

namespace tpc {

/// Whether roscpp's time was simulated when last looked at.
extern std::atomic<bool> TimeIsSimulated;

class LogFile {
public:
  /// Makes a file in the folder of \p C; null, with \p Why, where that cannot
  /// be. A file is never deleted: threads may write to it at any time.
  static LogFile *open(const Config &C, std::string &Why);

  /// The same as write() where nothing stands in the way; else does nothing and
  /// returns false.
  bool writeAtOnce(Thread &T, const Site &S, uint32_t Bits, double Compared,
                   double Threshold) {
    if (T.File != this || T.Next == T.End || T.Simulated != -1 ||
        S.WrittenTo.load(std::memory_order_relaxed) != this ||
        TimeIsSimulated.load(std::memory_order_relaxed))
      return false;
    put(*T.Next++, layout::ReportRecord | Bits, S.Number, Clock::now(),
        Compared, Threshold);
    return true;
  }

  /// Writes one report of the calling thread; false where the file takes no
  /// more.
  bool write(Thread &T, Site &S, uint32_t Bits, double Compared,
             double Threshold) {
    if ((T.File != this || T.Next == T.End) && !nextChunk(T))
      return false;
    if (S.WrittenTo.load(std::memory_order_relaxed) != this)
      announce(S);
    int64_t Now = Clock::now();
    if ((TimeIsSimulated.load(std::memory_order_relaxed) ||
         T.Simulated != -1) &&
        !simulated(T, Now))
      return false;
    put(*T.Next++, layout::ReportRecord | Bits, S.Number, Now, Compared,
        Threshold);
    return true;
  }

  void write(const Summary &S);
  void write(const Dropped &D);
  void writePolicy(const Config &C);
  /// The clocks against one another.
  void sync();
  /// Two empty slots that are read where the process ends suddenly; null where
  /// there is no room.
  SlotPair *newPair(Thread &T);

  /// The helper thread's: makes room ahead, gives back what is full.
  void lookAhead();
  void setNode(const char *Name);
  /// Whether it is stopped: disk full, or the limit reached.
  bool isStopped() const { return Stopped.load(std::memory_order_relaxed); }
  /// No more chunks are given out; what was not used is cut off.
  void close();

  const std::string &path() const { return Path; }
  uint64_t records() const { return Records.load(std::memory_order_relaxed); }

private:
  static constexpr uint32_t ExtentBytes = 1U << 20;
  static constexpr uint32_t ChunksOfExtent = ExtentBytes / layout::ChunkBytes;

  struct Extent {
    char *Base;
    uint32_t Done = 0; ///< chunks that nobody writes to any more
    bool IsTouched = false;
  };

  LogFile(const Config &C, std::string Path, int Descriptor);

  template <typename Number>
  static void put(layout::Record &R, uint32_t What, uint32_t Site, int64_t Ns,
                  Number A, Number B) {
    R.Site = Site;
    R.Steady = Ns;
    if constexpr (std::is_same_v<Number, double>) {
      R.Numbers[0] = A;
      R.Numbers[1] = B;
    } else {
      R.Integers[0] = A;
      R.Integers[1] = B;
    }
    __atomic_store_n(&R.What, What, __ATOMIC_RELEASE);
  }

  bool nextChunk(Thread &T);
  bool simulated(Thread &T, int64_t Now);
  void announce(Site &S);
  void announceLocked(Site &S);
  /// Room for \p Count records in a row in a system chunk; null where there is
  /// none. SystemLock is held.
  layout::Record *systemRecords(uint32_t Count);
  char *newChunk(uint32_t Kind, uint32_t Thread, uint64_t First, uint64_t Tid);
  void finished(const void *EndOfChunk);
  bool isMine() const;
  bool grow(std::string &Why);
  void stop(const std::string &Why);
  void touch();

  const std::string Path;
  const int Descriptor;
  dev_t Device = 0;
  ino_t Inode = 0;
  const uint64_t LimitBytes, ReserveBytes;
  layout::Header *Header = nullptr;

  std::mutex Chunks; ///< of the next six
  std::vector<Extent> Extents;
  uint32_t Used = 0; ///< chunks given out
  uint32_t Ahead = 1;
  bool Starved = false;
  bool IsClosed = false;
  bool Asked = false;
  std::mutex Growing;

  std::mutex SystemLock; ///< of the system's chunk and of pairs
  layout::Record *SystemNext = nullptr, *SystemEnd = nullptr;
  uint64_t SystemWritten = 0;
  char *LiveNext = nullptr, *LiveEnd = nullptr;

  std::atomic<bool> Stopped{false};
  std::atomic<uint64_t> Records{0};
};

} // namespace tpc

#endif // TPC_LOGFILE_H
