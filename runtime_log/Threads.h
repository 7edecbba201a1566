//===- Threads.h - What each reporting thread has of its own --------------===//
#ifndef TPC_THREADS_H
#define TPC_THREADS_H

#include "Layout.h"

#include <atomic>
#include <cstdint>
#include <mutex>
#include <vector>

namespace tpc {

class LogFile;

/// The two slots of a site in one thread: even and odd periods take turns, so
/// that one is read while the other is written.
struct SlotPair {
  layout::Slot Of[2];
};

/// A thread that reports. When it ends, the next new one takes its place.
struct Thread {
  /// Where its next report stands in the file's chunk, and the chunk's end.
  layout::Record *Next = nullptr;
  layout::Record *End = nullptr;
  /// The file that these are in.
  LogFile *File = nullptr;
  /// Odd while it reports.
  std::atomic<uint32_t> Inside{0};
  uint32_t Number = 0;    ///< from 1
  int64_t Simulated = -1; ///< the last simulated time in the file
  uint64_t Written = 0;   ///< records in the chunks before this one
  std::atomic<uint64_t> Nested{0};

  /// By the site's number; what `edges` keeps.
  SlotPair **Pairs = nullptr;
  uint32_t PairCount = 0;
  const LogFile *PairsHome = nullptr; ///< the file they are in; null: memory
  uint64_t Tid = 0;
  /// The slots with something in them, of even and of odd periods.
  std::vector<layout::Slot *> Touched[2];
  std::mutex Lock; ///< of Touched
};

/// The calling thread's; makes it at its first report. Null while the thread
/// is inside of this function already.
Thread *makeThread();

/// Of the calling thread; null before its first report. (`__thread`: no
/// initialisation is looked for at each access.)
extern __thread Thread *ThisThread __attribute__((tls_model("initial-exec")));

/// Calls \p Do with every thread there ever was.
std::vector<Thread *> allThreads();

void lockThreads();
void unlockThreads();
/// In the child of a fork, where only the calling thread goes on.
void threadsAfterFork();

} // namespace tpc

#endif // TPC_THREADS_H
