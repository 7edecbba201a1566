//===- MappedFile.cpp -----------------------------------------------------===//
#include "MappedFile.h"

#include "Clock.h"
#include "Runtime.h"

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#ifndef MADV_POPULATE_WRITE // Linux 5.14
#define MADV_POPULATE_WRITE 23
#endif

namespace tpc {

using namespace layout;

static constexpr uint32_t MostAhead = 64; ///< in extents

MappedFile::MappedFile(const Config &C, const NewFile &File)
    : Path(File.Path), Descriptor(File.Descriptor),
      LimitBytes((File.Segment ? C.RingBudgetMiB : C.FileLimitMiB) << 20),
      ReserveBytes(C.FileReserveMiB << 20),
      AheadBytes(File.Segment ? C.segmentBytes() : UINT64_MAX),
      Segment(File.Segment) {
  struct stat Its;
  if (!fstat(Descriptor, &Its)) {
    Device = Its.st_dev;
    Inode = Its.st_ino;
  }
}

/// False if the program has closed the descriptor, as daemons do with all of
/// them, and perhaps opened a file of its own under the same number.
bool MappedFile::isMine() const {
  struct stat Its;
  return !fstat(Descriptor, &Its) && Its.st_dev == Device &&
         Its.st_ino == Inode;
}

/// Allocates space on the disk, so that writing to the mapping cannot fail;
/// returns 0 or the error.
static int allocate(int Descriptor, off_t Begin, off_t Length) {
  int Error;
  do
    Error = posix_fallocate(Descriptor, Begin, Length);
  while (Error == EINTR);
  return Error;
}

/// Whether the file may grow to \p End bytes.
bool MappedFile::isAllowed(uint64_t End, std::string &Why) const {
  // Beyond this limit the process would get a signal.
  rlimit Limit;
  if (!getrlimit(RLIMIT_FSIZE, &Limit) && End > Limit.rlim_cur) {
    Why = "the limit on the size of files (ulimit -f) is reached";
    return false;
  }
  if (LimitBytes && End > LimitBytes) {
    Why = "its limit of " + std::to_string(LimitBytes >> 20) +
          " MiB (TPC_FILE_LIMIT) is reached";
    return false;
  }
  struct statvfs Disk;
  if (ReserveBytes && !fstatvfs(Descriptor, &Disk) &&
      static_cast<uint64_t>(Disk.f_bavail) * Disk.f_frsize <
          ReserveBytes + ExtentBytes) {
    Why = "the disk has less than " + std::to_string(ReserveBytes >> 20) +
          " MiB left (TPC_FILE_RESERVE)";
    return false;
  }
  return true;
}

char *MappedFile::map(uint64_t At, size_t Size, std::string &Why) const {
  void *P = mmap(nullptr, Size, PROT_READ | PROT_WRITE, MAP_SHARED, Descriptor,
                 static_cast<off_t>(At));
  if (P != MAP_FAILED)
    return static_cast<char *>(P);
  Why = "cannot map it: " + errorText(errno);
  return nullptr;
}

bool MappedFile::grow(std::string &Why) {
  uint64_t Count;
  {
    std::lock_guard<std::mutex> Guard(Chunks);
    Count = Extents.size();
  }
  uint64_t Begin = HeaderBytes + Count * ExtentBytes, End = Begin + ExtentBytes;
  if (!isMine()) {
    Why = "the program has closed its descriptor";
    return false;
  }
  if (!isAllowed(End, Why))
    return false;
  if (int Error = allocate(Descriptor, Header ? static_cast<off_t>(Begin) : 0,
                           static_cast<off_t>(Header ? ExtentBytes : End))) {
    Why = errorText(Error);
    return false;
  }
  if (!Header) {
    auto *H = reinterpret_cast<layout::Header *>(map(0, HeaderBytes, Why));
    if (!H)
      return false;
    H->HeaderSize = HeaderBytes;
    H->RecordSize = RecordBytes;
    H->ChunkSize = ChunkBytes;
    H->Pid = static_cast<uint32_t>(getpid());
    H->Steady = Clock::steady();
    H->Real = Clock::real();
    H->Counter = Clock::usesCounter();
    H->Segment = Segment;
    gethostname(H->Host, sizeof(H->Host) - 1);
    programPath().copy(H->Program, sizeof(H->Program) - 1);
    std::memcpy(H->Magic, "TPCLOG1\n", sizeof(H->Magic));
    Header = H;
  }
  char *Base = map(Begin, ExtentBytes, Why);
  if (!Base)
    return false;
  std::lock_guard<std::mutex> Guard(Chunks);
  Extents.push_back({Base});
  return true;
}

char *MappedFile::newChunk(uint32_t Kind, uint32_t Thread, uint64_t First,
                           uint64_t Tid) {
  for (;;) {
    {
      std::lock_guard<std::mutex> Guard(Chunks);
      if (IsClosed || Stopped.load(std::memory_order_relaxed))
        return nullptr;
      uint32_t Mapped = static_cast<uint32_t>(Extents.size()) * ChunksOfExtent;
      if (Used < Mapped) {
        Extent &E = Extents[Used / ChunksOfExtent];
        char *Chunk = E.Base + size_t(Used % ChunksOfExtent) * ChunkBytes;
        ++Used;
        Starved |= !E.IsTouched;
        auto *H = reinterpret_cast<ChunkHeader *>(Chunk);
        H->Thread = Thread;
        H->First = First;
        H->Tid = Tid;
        __atomic_store_n(&H->Kind, Kind, __ATOMIC_RELEASE);
        if ((Mapped - Used) * 2 < Ahead * ChunksOfExtent && !Asked) {
          Asked = true;
          wakeHelper();
        }
        return Chunk;
      }
      Starved = true;
    }
    std::lock_guard<std::mutex> Guard(Growing);
    {
      std::lock_guard<std::mutex> Inner(Chunks);
      if (IsClosed)
        return nullptr;
      if (Used < Extents.size() * ChunksOfExtent)
        continue;
    }
    std::string Why;
    if (!isStopped() && !grow(Why))
      stop(Why);
  }
}

void MappedFile::stop(const std::string &Why) {
  if (Stopped.exchange(true))
    return;
  Header->State = layout::Stopped;
  if (Segment)
    return wakeHelper(); // which begins another one, or says that it cannot
  warn(Path + ": " + Why + "; recording stops, and the program continues");
}

void MappedFile::touch() {
  for (size_t I = 0;; ++I) {
    char *Base;
    {
      std::lock_guard<std::mutex> Guard(Chunks);
      while (I < Extents.size() && (Extents[I].IsTouched || !Extents[I].Base))
        ++I;
      if (I == Extents.size())
        return;
      Base = Extents[I].Base;
    }
    // Reports may be written to it meanwhile, so nothing is changed here.
    if (madvise(Base, ExtentBytes, MADV_POPULATE_WRITE))
      for (uint32_t At = 0; At < ExtentBytes; At += 4096)
        __atomic_fetch_or(Base + At, 0, __ATOMIC_RELAXED);
    std::lock_guard<std::mutex> Guard(Chunks);
    Extents[I].IsTouched = true;
  }
}

void MappedFile::lookAhead() {
  std::vector<char *> Full;
  for (;;) {
    {
      std::lock_guard<std::mutex> Guard(Chunks);
      Asked = false;
      if (Starved && Ahead < MostAhead)
        Ahead *= 2;
      Starved = false;
      for (Extent &E : Extents)
        if (E.Done == ChunksOfExtent && E.IsTouched && E.Base) {
          Full.push_back(E.Base);
          E.Base = nullptr;
        }
      if (IsClosed || isStopped() ||
          HeaderBytes + (Extents.size() + 1) * ExtentBytes > AheadBytes ||
          Extents.size() * ChunksOfExtent - Used >=
              size_t(Ahead) * ChunksOfExtent)
        break;
    }
    std::lock_guard<std::mutex> Guard(Growing);
    std::string Why;
    // A full disk is reported when the space is needed.
    if (!grow(Why))
      break;
    touch();
  }
  for (char *Base : Full)
    munmap(Base, ExtentBytes);
}

void MappedFile::finish(const void *EndOfChunk) {
  const char *Chunk = static_cast<const char *>(EndOfChunk) - ChunkBytes;
  std::lock_guard<std::mutex> Guard(Chunks);
  for (size_t I = Extents.size(); I-- > 0;) {
    Extent &E = Extents[I];
    if (E.Base && Chunk >= E.Base && Chunk < E.Base + ExtentBytes) {
      ++E.Done;
      return;
    }
  }
}

void MappedFile::close() {
  std::lock_guard<std::mutex> Guard(Growing);
  std::lock_guard<std::mutex> Inner(Chunks);
  if (IsClosed)
    return;
  IsClosed = true;
  // Nobody writes behind the last chunk that was given out.
  if (isMine() && ftruncate(Descriptor, HeaderBytes + static_cast<off_t>(Used) *
                                                          ChunkBytes))
    warn(Path + ": " + errorText(errno));
  // A thread that still wants to extend the file sees that it is closed, or no
  // longer its own.
  if (isMine())
    ::close(Descriptor);
  if (!isStopped())
    Header->State = layout::Closed;
}

void MappedFile::unmap() {
  std::lock_guard<std::mutex> Guard(Chunks);
  for (Extent &E : Extents)
    if (E.Base)
      munmap(E.Base, ExtentBytes);
  Extents = {};
  munmap(Header, HeaderBytes);
  Header = nullptr;
}

uint64_t MappedFile::usedBytes() {
  std::lock_guard<std::mutex> Guard(Chunks);
  return HeaderBytes + uint64_t(Used) * ChunkBytes;
}

uint64_t MappedFile::diskBytes() {
  std::lock_guard<std::mutex> Guard(Chunks);
  return HeaderBytes + (IsClosed ? uint64_t(Used) * ChunkBytes
                                 : uint64_t(Extents.size()) * ExtentBytes);
}

bool MappedFile::holds(const void *Address) {
  const char *At = static_cast<const char *>(Address);
  std::lock_guard<std::mutex> Guard(Chunks);
  for (const Extent &E : Extents)
    if (E.Base && At >= E.Base && At < E.Base + ExtentBytes)
      return true;
  return false;
}

void MappedFile::goOnFrom(MappedFile &Before) {
  std::lock_guard<std::mutex> Guard(Before.Chunks);
  Ahead = Before.Ahead;
}

} // namespace tpc
