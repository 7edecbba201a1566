//===- MappedFile.h - The space of the mapped file ------------------------===//
//
// Space is allocated on the disk before it is mapped, so that a full disk is an
// error and not a signal. The helper thread touches the pages in advance, so
// that no report waits for one. A chunk belongs to the thread that it was given
// to. The kernel keeps what is written to it, whatever happens to the process.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_MAPPEDFILE_H
#define TPC_MAPPEDFILE_H

#include "Config.h"
#include "Layout.h"
#include "NewFile.h"

#include <atomic>
#include <mutex>
#include <string>
#include <sys/types.h>
#include <utility>
#include <vector>

namespace tpc {

/// The space of one file: grows by extents, which are given out in chunks.
class MappedFile {
public:
  MappedFile(const Config &C, const NewFile &File);

  /// Maps one more extent, the first one together with the header; if that
  /// fails, returns false and sets \p Why.
  bool grow(std::string &Why);
  /// A chunk for thread \p Thread, which has written \p First records before;
  /// null if there is no more space.
  char *newChunk(uint32_t Kind, uint32_t Thread, uint64_t First, uint64_t Tid);
  /// Nobody writes any more to the chunk that ends at \p EndOfChunk.
  void finish(const void *EndOfChunk);
  /// Brings the pages of all extents into memory.
  void touch();
  /// For the helper thread: allocates space ahead and releases what is full.
  void lookAhead();
  /// No more chunks are given out; the unused end of the file is cut off.
  void close();
  /// After close(): nobody uses the file any more, and its memory is given
  /// back.
  void unmap();

  /// Bytes that the chunks that were given out take, with the header.
  uint64_t usedBytes();
  /// Bytes that the file takes on the disk.
  uint64_t diskBytes();
  /// Whether \p Address is in one of its extents.
  bool holds(const void *Address);
  /// Allocates ahead as much as \p Before did.
  void goOnFrom(MappedFile &Before);
  /// Which file it is, whatever its name: device and inode.
  std::pair<dev_t, ino_t> identity() const { return {Device, Inode}; }

  /// Whether it has stopped because the disk is full or a limit is reached.
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
  /// Space is allocated ahead up to this size.
  const uint64_t AheadBytes;
  const uint32_t Segment;
  layout::Header *Header = nullptr;

  std::mutex Chunks; ///< for the next six
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

#endif // TPC_MAPPEDFILE_H
