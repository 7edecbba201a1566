//===- Ring.h - The last minutes, in several files ------------------------===//
//
// A ring is a sequence of files of one process. Each is a whole file of
// reports. The helper thread begins a new one when the present one has its
// share of the minutes or of the budget, and removes the oldest. Threads may
// still be inside a report to the file that was left, so it is closed once they
// are not.
//
// Everything here is called by one thread at a time: the helper, or one that
// holds its lock.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_RING_H
#define TPC_RING_H

#include "Config.h"
#include "NewFile.h"

#include <cstdint>
#include <string>
#include <sys/types.h>
#include <utility>
#include <vector>

namespace tpc {

class LogFile;
struct Thread;

class Ring {
public:
  /// Removes files until the budget has space for the next one. False if the
  /// next one must not be begun: a thread is still inside a report to the
  /// oldest file, and all files could take more than twice the budget.
  bool makeRoom(const Config &C, LogFile *Now);
  /// After makeRoom() has failed: when the oldest file was left, in steady
  /// time.
  int64_t heldSince() const;
  /// Begins the next file. Makes room for it first, also on the disk as far as
  /// removing files helps. If that fails, returns null and sets \p Why.
  LogFile *next(const Config &C, LogFile *Now, std::string &Why);
  /// Whether \p Now has its share of minutes or bytes, or has stopped.
  bool isDue(const Config &C, LogFile &Now, int64_t Steady) const;
  /// When the present file has its share of the minutes, in steady time.
  int64_t dueAt(const Config &C) const;
  /// Another file than \p Old is written from now on.
  void leave(LogFile &Old, int64_t Steady);
  /// Closes the files that nobody writes to any more, and removes those that
  /// are older than the minutes.
  void settle(const Config &C, int64_t Steady);
  /// The process ends: closes the files that were left.
  void end();
  /// In the child of a fork, where all files are the parent's.
  void forget();

  /// How many files there are besides the present one, and their bytes.
  std::pair<size_t, uint64_t> size() const;

private:
  /// A file that was left. Its name may be anybody's by now.
  struct Former {
    std::string Path;
    std::pair<dev_t, ino_t> Identity;
    uint64_t Bytes;
    int64_t End; ///< when it was left, in steady time
    LogFile *File;
    bool IsClosed;
    /// The threads that were inside a report then, with their state.
    std::vector<std::pair<Thread *, uint32_t>> Inside;
  };

  bool removeOldest();
  static bool isLeft(Former &F);
  void release(LogFile *File);
  void deleteUnknown();

  SegmentName Name;
  int64_t Began = 0; ///< the present file, in steady time
  std::vector<Former> Files;
  /// They have no memory mapped; threads and sites may still know them.
  std::vector<LogFile *> Unmapped;
};

} // namespace tpc

#endif // TPC_RING_H
