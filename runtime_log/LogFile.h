//===- LogFile.h - The binary file of reports -----------------------------===//
//
// Records are written directly into the mapped file. Layout.h defines its
// layout, MappedFile.h manages its space, NewFile.h its name.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_LOGFILE_H
#define TPC_LOGFILE_H

#include "Clock.h"
#include "Config.h"
#include "Layout.h"
#include "MappedFile.h"
#include "Report.h"
#include "Sites.h"
#include "Threads.h"

#include <atomic>
#include <mutex>
#include <string>

namespace tpc {

/// Whether roscpp's time was simulated when it was last checked.
extern std::atomic<bool> TimeIsSimulated;

class LogFile {
public:
  /// Creates a file in the folder of \p C, the next one of the ring \p Of
  /// unless that is null; if that fails, returns null and sets \p Why. Threads
  /// may write to a file at any time: only a ring deletes one, when none does
  /// any more.
  static LogFile *open(const Config &C, SegmentName *Of, std::string &Why);

  /// Writes one report if no slow path is needed; otherwise does nothing and
  /// returns false.
  [[gnu::always_inline]] bool writeAtOnce(Thread &T, const Site &S,
                                          uint32_t Bits, double Compared,
                                          double Threshold) {
    if (T.File.load(std::memory_order_relaxed) != this || T.Next == T.End ||
        T.Simulated != -1 ||
        S.WrittenTo.load(std::memory_order_relaxed) != this ||
        TimeIsSimulated.load(std::memory_order_relaxed))
      return false;
    put(*T.Next++, layout::ReportRecord | Bits, S.Number, Clock::now(),
        Compared, Threshold);
    return true;
  }

  /// Writes one report of the calling thread; false if the file accepts no
  /// more.
  bool write(Thread &T, Site &S, uint32_t Bits, double Compared,
             double Threshold) {
    if ((T.File.load(std::memory_order_relaxed) != this || T.Next == T.End) &&
        !nextChunk(T))
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

  /// One report of earlier, written by \p T, with the time that it had; its
  /// site is announced. \p Simulated: -1 if the time is not.
  void writeLate(Thread &T, const Site &S, uint32_t Bits, int64_t Steady,
                 int64_t Simulated, double Compared, double Threshold);
  void announce(Site &S);

  void write(const Summary &S);
  void write(const Dropped &D);
  void write(const ReadName &N);
  void writePolicy(const Config &C);
  /// Records the two clocks against each other.
  void sync();
  /// Two empty slots that can be read even if the process ends suddenly; null
  /// if there is no space.
  SlotPair *newPair(Thread &T);

  /// For the helper thread: allocates space ahead and releases what is full.
  void lookAhead() { Space.lookAhead(); }
  void setNode(const char *Name);
  /// Whether it has stopped because the disk is full or a limit is reached.
  bool isStopped() const { return Space.isStopped(); }
  /// No more chunks are given out; the unused end of the file is cut off.
  void close() { Space.close(); }
  /// After close(): nobody uses the file any more.
  void unmap() { Space.unmap(); }
  uint64_t usedBytes() { return Space.usedBytes(); }
  uint64_t diskBytes() { return Space.diskBytes(); }
  bool holds(const void *Address) { return Space.holds(Address); }
  void goOnFrom(LogFile &Before) { Space.goOnFrom(Before.Space); }
  std::pair<dev_t, ino_t> identity() const { return Space.identity(); }

  const std::string &path() const { return Space.path(); }
  uint64_t records() const { return Records.load(std::memory_order_relaxed); }

private:
  LogFile(const Config &C, const NewFile &File) : Space(C, File) {}

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
  void announceLocked(Site &S);
  bool writeText(uint32_t What, uint32_t Site, const std::string &Text);
  /// Space for \p Count consecutive records in a system chunk; null if there is
  /// none. SystemLock is held.
  layout::Record *systemRecords(uint32_t Count);

  MappedFile Space;

  std::mutex SystemLock; ///< for the system chunk and for pairs
  layout::Record *SystemNext = nullptr, *SystemEnd = nullptr;
  uint64_t SystemWritten = 0;
  char *LiveNext = nullptr, *LiveEnd = nullptr;

  std::atomic<uint64_t> Records{0};
};

} // namespace tpc

#endif // TPC_LOGFILE_H
