//===- Threads.h - The state of each reporting thread ---------------------===//
#ifndef TPC_THREADS_H
#define TPC_THREADS_H

#include "Layout.h"

#include <atomic>
#include <cstdint>
#include <mutex>
#include <vector>

namespace tpc {

class LogFile;

/// The two slots of a site in one thread, for even and odd periods: one is read
/// while the other is written.
struct SlotPair {
  layout::Slot Of[2];
};

/// A thread that reports. When it ends, the next new thread reuses its place.
struct Thread {
  /// Where its next report goes in the chunk of the file, and where the chunk
  /// ends.
  layout::Record *Next = nullptr;
  layout::Record *End = nullptr;
  /// The file that contains both.
  std::atomic<LogFile *> File{nullptr};
  /// Odd while the thread reports.
  std::atomic<uint32_t> Inside{0};
  uint32_t Number = 0;    ///< from 1
  int64_t Simulated = -1; ///< the last simulated time written to the file
  uint64_t Written = 0;   ///< records in the chunks before this one
  std::atomic<uint64_t> Nested{0};

  /// Indexed by the number of the site; used by `edges`.
  SlotPair **Pairs = nullptr;
  uint32_t PairCount = 0;
  /// The file that contains them; null: memory.
  std::atomic<const LogFile *> PairsHome{nullptr};
  uint64_t Tid = 0;
  /// The slots in use, of even and of odd periods.
  std::vector<layout::Slot *> Touched[2];
  std::mutex Lock; ///< for Touched
};

/// Marks \p T as inside a report, unless it is already: a signal handler, or
/// code that is called from a report, may report too.
class ReportMark {
public:
  explicit ReportMark(Thread &T)
      : T(T), Before(T.Inside.load(std::memory_order_relaxed)) {
    if (!*this)
      return;
    T.Inside.store(Before + 1, std::memory_order_relaxed);
    std::atomic_signal_fence(std::memory_order_seq_cst);
  }
  ~ReportMark() {
    if (*this)
      T.Inside.store(Before + 2, std::memory_order_release);
  }
  ReportMark(const ReportMark &) = delete;
  ReportMark &operator=(const ReportMark &) = delete;

  /// Whether the thread was not inside a report before.
  explicit operator bool() const { return !(Before & 1); }

private:
  Thread &T;
  const uint32_t Before;
};

/// The calling thread; creates it at its first report. Null while the thread is
/// already inside this function.
Thread *makeThread();

/// The calling thread; null before its first report. `__thread`: an access does
/// not check for initialisation.
extern __thread Thread *ThisThread __attribute__((tls_model("initial-exec")));

/// All threads that ever reported.
std::vector<Thread *> allThreads();

void lockThreads();
void unlockThreads();
/// In the child of a fork, where only the calling thread exists.
void threadsAfterFork();

} // namespace tpc

#endif // TPC_THREADS_H
