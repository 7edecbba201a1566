//===- Room.h - The mapped file, chunk by chunk ---------------------------===//
//
// Space is allocated on the disk before it is mapped, so that a full disk is an
// error and no signal, and its pages are touched ahead by the helper thread, so
// that a report waits for none. A chunk belongs to whom it was given to; what
// is written to it the kernel keeps, whatever happens to the process.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_ROOM_H
#define TPC_ROOM_H

#include "Config.h"
#include "Layout.h"
#include "NewFile.h"

#include <atomic>
#include <mutex>
#include <string>
#include <sys/types.h>
#include <vector>

namespace tpc {

class Room {
public:
  Room(const Config &C, const NewFile &File);

  /// Maps one extent more, the first time with the header; false, with \p Why,
  /// where that cannot be.
  bool grow(std::string &Why);
  /// A chunk for thread \p Thread, which has written \p First records before;
  /// null where there is no room any more.
  char *newChunk(uint32_t Kind, uint32_t Thread, uint64_t First, uint64_t Tid);
  /// Nobody writes to the chunk that ends there any more.
  void finish(const void *EndOfChunk);
  /// Has the pages of all extents in memory.
  void touch();
  /// The helper thread's: makes room ahead, gives back what is full.
  void lookAhead();
  /// No more chunks are given out; what was not used is cut off.
  void close();

  /// Whether it is stopped: disk full, or the limit reached.
  bool isStopped() const { return Stopped.load(std::memory_order_relaxed); }
  layout::Header &header() { return *Header; }
  const std::string &path() const { return Path; }

private:
  static constexpr uint32_t ExtentBytes = 1U << 20;
  static constexpr uint32_t ChunksOfExtent = ExtentBytes / layout::ChunkBytes;

  struct Extent {
    char *Base;
    uint32_t Done = 0; ///< chunks that nobody writes to any more
    bool IsTouched = false;
  };

  bool isMine() const;
  bool isAllowed(uint64_t End, std::string &Why) const;
  char *map(uint64_t At, size_t Size, std::string &Why) const;
  void stop(const std::string &Why);

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

  std::atomic<bool> Stopped{false};
};

} // namespace tpc

#endif // TPC_ROOM_H
