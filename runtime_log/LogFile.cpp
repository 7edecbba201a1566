//===- LogFile.cpp --------------------------------------------------------===//
#include "LogFile.h"

#include "RosControl.h"
#include "Runtime.h"

#include <algorithm>
#include <cerrno>
#include <cstdlib>
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

std::atomic<bool> TimeIsSimulated{false};

static constexpr uint32_t MostAhead = 64; ///< extents
static constexpr size_t LongestKey = 4096;

//===----------------------------------------------------------------------===//
// Opening
//===----------------------------------------------------------------------===//

static std::string reason(int Error) {
  char Buffer[128];
  return strerror_r(Error, Buffer, sizeof(Buffer));
}

static std::string folderOf(const Config &C) {
  if (!C.Folder.empty())
    return C.Folder;
  if (const char *Home = std::getenv("ROS_HOME"); Home && *Home)
    return std::string(Home) + "/tpc";
  const char *Home = std::getenv("HOME");
  return std::string(Home ? Home : "/tmp") + "/.ros/tpc";
}

static bool makeFolder(const std::string &Folder) {
  for (size_t End = 1; End != std::string::npos;) {
    End = Folder.find('/', End + 1);
    if (mkdir(Folder.substr(0, End).c_str(), 0777) && errno != EEXIST &&
        errno != EISDIR)
      return false;
  }
  return true;
}

static std::string program() {
  char Buffer[sizeof(Header::Program)];
  ssize_t Length = readlink("/proc/self/exe", Buffer, sizeof(Buffer) - 1);
  return std::string(Buffer, std::max<ssize_t>(Length, 0));
}

/// What the file is called by: the node, else the program.
static std::string nameOfProcess() {
  std::string Name = rosNodeName();
  if (Name.empty()) {
    Name = program();
    Name = Name.substr(Name.rfind('/') + 1);
  }
  while (!Name.empty() && Name.front() == '/')
    Name.erase(0, 1);
  for (char &C : Name)
    if (!std::isalnum(static_cast<unsigned char>(C)) && C != '_' && C != '-')
      C = '_';
  return Name.empty() ? "process" : Name.substr(0, 100);
}

LogFile *LogFile::open(const Config &C, std::string &Why) {
  std::string Folder = folderOf(C);
  if (!makeFolder(Folder)) {
    Why = Folder + ": " + reason(errno);
    return nullptr;
  }
  std::string Stem = Folder + "/" + nameOfProcess() + "-" +
                     std::to_string(getpid()) + "-" +
                     std::to_string(Clock::real() / 1'000'000'000);
  for (int Try = 1;; ++Try) {
    std::string Path =
        Stem + (Try > 1 ? "-" + std::to_string(Try) : "") + ".tpc";
    // It gets its name when it can be read. Until then the other one keeps out
    // whoever has the same number in another container, and so the same names.
    std::string New = Path + ".new";
    int Descriptor =
        ::open(New.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    bool IsTaken = Descriptor < 0 && errno == EEXIST;
    if (Descriptor >= 0 && !access(Path.c_str(), F_OK)) {
      IsTaken = true;
      ::close(Descriptor);
      unlink(New.c_str());
    }
    if (IsTaken && Try < 1000)
      continue;
    if (Descriptor < 0 || IsTaken) {
      Why = Path + ": " + reason(IsTaken ? EEXIST : errno);
      return nullptr;
    }
    auto *File = new LogFile(C, Path, Descriptor);
    bool IsThere = File->grow(Why);
    if (IsThere && rename(New.c_str(), Path.c_str())) {
      IsThere = false;
      Why = reason(errno);
    }
    if (IsThere) {
      File->touch();
      File->sync();
      return File;
    }
    Why = Path + ": " + Why;
    unlink(New.c_str());
    ::close(Descriptor);
    delete File;
    return nullptr;
  }
}

LogFile::LogFile(const Config &C, std::string Path, int Descriptor)
    : Path(std::move(Path)), Descriptor(Descriptor),
      LimitBytes(C.FileLimitMiB << 20), ReserveBytes(C.FileReserveMiB << 20) {
  struct stat Its;
  if (!fstat(Descriptor, &Its)) {
    Device = Its.st_dev;
    Inode = Its.st_ino;
  }
}

/// A program that closes all descriptors, as daemons do, may have opened a file
/// of its own in the place of this one.
bool LogFile::isMine() const {
  struct stat Its;
  return !fstat(Descriptor, &Its) && Its.st_dev == Device &&
         Its.st_ino == Inode;
}

//===----------------------------------------------------------------------===//
// Room
//===----------------------------------------------------------------------===//

/// Allocates on the disk, so that writing to the mapping cannot fail; 0 or the
/// error.
static int allocate(int Descriptor, off_t Begin, off_t Length) {
  int Error;
  do
    Error = posix_fallocate(Descriptor, Begin, Length);
  while (Error == EINTR);
  return Error;
}

bool LogFile::grow(std::string &Why) {
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
  if (int Error = allocate(Descriptor, Header ? Begin : 0,
                           Header ? ExtentBytes : End)) {
    Why = reason(Error);
    return false;
  }
  auto Map = [&](uint64_t At, size_t Size) {
    void *P = mmap(nullptr, Size, PROT_READ | PROT_WRITE, MAP_SHARED,
                   Descriptor, static_cast<off_t>(At));
    if (P == MAP_FAILED)
      Why = "mapping it: " + reason(errno);
    return P == MAP_FAILED ? nullptr : static_cast<char *>(P);
  };
  if (!Header) {
    auto *H = reinterpret_cast<layout::Header *>(Map(0, HeaderBytes));
    if (!H)
      return false;
    H->HeaderSize = HeaderBytes;
    H->RecordSize = RecordBytes;
    H->ChunkSize = ChunkBytes;
    H->Pid = static_cast<uint32_t>(getpid());
    H->Steady = Clock::steady();
    H->Real = Clock::real();
    H->Counter = Clock::usesCounter();
    gethostname(H->Host, sizeof(H->Host) - 1);
    program().copy(H->Program, sizeof(H->Program) - 1);
    std::memcpy(H->Magic, "TPCLOG1\n", sizeof(H->Magic));
    Header = H;
    setNode(rosNodeName());
  }
  char *Base = Map(Begin, ExtentBytes);
  if (!Base)
    return false;
  std::lock_guard<std::mutex> Guard(Chunks);
  Extents.push_back({Base});
  return true;
}

char *LogFile::newChunk(uint32_t Kind, uint32_t Thread, uint64_t First,
                        uint64_t Tid) {
  for (;;) {
    {
      std::lock_guard<std::mutex> Guard(Chunks);
      if (IsClosed || Stopped.load(std::memory_order_relaxed))
        return nullptr;
      uint32_t Mapped = static_cast<uint32_t>(Extents.size()) * ChunksOfExtent;
      if (Used < Mapped) {
        Extent &E = Extents[Used / ChunksOfExtent];
        char *Chunk = E.Base + (Used % ChunksOfExtent) * ChunkBytes;
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

void LogFile::stop(const std::string &Why) {
  if (Stopped.exchange(true))
    return;
  Header->State = layout::Stopped;
  warn(Path + ": " + Why +
       "; nothing more is recorded, the program goes on as if it were");
}

void LogFile::touch() {
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
    // Reports may be written to it meanwhile: nothing is changed here.
    if (madvise(Base, ExtentBytes, MADV_POPULATE_WRITE))
      for (uint32_t At = 0; At < ExtentBytes; At += 4096)
        __atomic_fetch_or(Base + At, 0, __ATOMIC_RELAXED);
    std::lock_guard<std::mutex> Guard(Chunks);
    Extents[I].IsTouched = true;
  }
}

void LogFile::lookAhead() {
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
          Extents.size() * ChunksOfExtent - Used >= Ahead * ChunksOfExtent)
        break;
    }
    std::lock_guard<std::mutex> Guard(Growing);
    std::string Why;
    // A full disk is said when the room is needed.
    if (!grow(Why))
      break;
    touch();
  }
  for (char *Base : Full)
    munmap(Base, ExtentBytes);
}

void LogFile::finished(const void *EndOfChunk) {
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

void LogFile::close() {
  std::lock_guard<std::mutex> Guard(Growing);
  std::lock_guard<std::mutex> Inner(Chunks);
  if (IsClosed)
    return;
  IsClosed = true;
  // Nobody writes behind the chunks that were given out.
  if (isMine() && ftruncate(Descriptor, HeaderBytes + static_cast<off_t>(Used) *
                                                          ChunkBytes))
    warn(Path + ": " + reason(errno));
  // Who still wants to grow it sees that it is closed, or not its own.
  if (isMine())
    ::close(Descriptor);
  if (!isStopped())
    Header->State = layout::Closed;
}

void LogFile::setNode(const char *Name) {
  if (!*Name || Header->Node[0])
    return;
  size_t Length = std::min(std::strlen(Name), sizeof(Header->Node) - 1);
  std::memcpy(Header->Node + 1, Name + 1, Length - 1);
  __atomic_store_n(&Header->Node[0], Name[0], __ATOMIC_RELEASE);
}

//===----------------------------------------------------------------------===//
// Records
//===----------------------------------------------------------------------===//

bool LogFile::nextChunk(Thread &T) {
  if (T.File == this && T.End) {
    T.Written += RecordsOfChunk;
    Records.fetch_add(RecordsOfChunk, std::memory_order_relaxed);
    finished(T.End);
  } else if (T.File != this) {
    T.Written = 0;
    T.Simulated = -1;
  }
  T.File = this;
  char *Chunk = newChunk(Reports, T.Number, T.Written, T.Tid);
  if (!Chunk) {
    T.Next = T.End = nullptr;
    __atomic_fetch_add(&Header->NotRecorded, 1, __ATOMIC_RELAXED);
    return false;
  }
  T.Next = reinterpret_cast<Record *>(Chunk + ChunkHeaderBytes);
  T.End = reinterpret_cast<Record *>(Chunk + ChunkBytes);
  return true;
}

bool LogFile::simulated(Thread &T, int64_t Now) {
  int64_t Sim = TimeIsSimulated.load(std::memory_order_relaxed) ? rosNow() : -1;
  if (Sim == T.Simulated)
    return true;
  T.Simulated = Sim;
  put(*T.Next++, SimulatedRecord, 0, Now, Sim, INT64_C(0));
  return T.Next != T.End || nextChunk(T);
}

Record *LogFile::systemRecords(uint32_t Count) {
  if (!SystemNext || SystemEnd - SystemNext < static_cast<ptrdiff_t>(Count)) {
    if (SystemNext) {
      // What is left over counts as used: numbers say which place is which.
      SystemWritten += RecordsOfChunk;
      finished(SystemEnd);
    }
    char *Chunk = newChunk(System, 0, SystemWritten, 0);
    if (!Chunk)
      return SystemNext = SystemEnd = nullptr;
    SystemNext = reinterpret_cast<Record *>(Chunk + ChunkHeaderBytes);
    SystemEnd = reinterpret_cast<Record *>(Chunk + ChunkBytes);
  }
  Record *R = SystemNext;
  SystemNext += Count;
  return R;
}

void LogFile::announce(Site &S) {
  std::lock_guard<std::mutex> Guard(SystemLock);
  announceLocked(S);
}

void LogFile::announceLocked(Site &S) {
  if (S.WrittenTo.load(std::memory_order_relaxed) == this)
    return;
  size_t Length = std::min(S.Key.size(), LongestKey);
  size_t InHead = std::min(Length, sizeof(Record::Text));
  auto Blocks =
      static_cast<uint32_t>((Length - InHead + RecordBytes - 1) / RecordBytes);
  Record *R = systemRecords(1 + Blocks);
  if (!R)
    return;
  std::memcpy(R->Text, S.Key.data(), InHead);
  std::memcpy(R + 1, S.Key.data() + InHead, Length - InHead);
  R->Site = S.Number;
  R->Steady = static_cast<int64_t>(Length);
  __atomic_store_n(&R->What, SiteRecord, __ATOMIC_RELEASE);
  S.WrittenTo.store(this, std::memory_order_relaxed);
}

void LogFile::sync() {
  std::lock_guard<std::mutex> Guard(SystemLock);
  if (Record *R = systemRecords(1)) {
    // The two clocks at one instant.
    int64_t Before = Clock::now(), Real = Clock::real(), After = Clock::now();
    Header->Counter = Clock::usesCounter();
    put(*R, SyncRecord, 0, Before + (After - Before) / 2, Real, rosNow());
  }
}

void LogFile::writePolicy(const Config &C) {
  std::lock_guard<std::mutex> Guard(SystemLock);
  if (Record *R = systemRecords(1))
    put(*R, PolicyRecord, static_cast<uint32_t>(C.Policy), Clock::now(),
        C.PeriodNs, INT64_C(0));
}

void LogFile::write(const Dropped &D) {
  std::lock_guard<std::mutex> Guard(SystemLock);
  if (Record *R = systemRecords(1))
    put(*R, DroppedRecord | static_cast<uint32_t>(D.Why) << ReasonShift, D.Site,
        Clock::now(), static_cast<int64_t>(D.Count),
        static_cast<int64_t>(D.Flops));
}

void LogFile::write(const tpc::Summary &S) {
  std::lock_guard<std::mutex> Guard(SystemLock);
  Record *R = systemRecords(sizeof(layout::Summary) / RecordBytes);
  if (!R)
    return;
  auto *Kept = reinterpret_cast<layout::Summary *>(R);
  Kept->Site = S.Site;
  Kept->BeginSteady = S.BeginSteady;
  Kept->Compared = S.Compared;
  Kept->Threshold = S.Threshold;
  Kept->EndSteady = S.EndSteady;
  Kept->Period = S.Period;
  Kept->Thread = S.Thread;
  Kept->Count = S.Count;
  Kept->Odd = S.Odd;
  Kept->Far = S.Far;
  Kept->DiffMin = S.DiffMin;
  Kept->DiffMax = S.DiffMax;
  Kept->DiffSum = S.DiffSum;
  Kept->AbsSum = S.AbsSum;
  Kept->Low = S.Low;
  Kept->High = S.High;
  Kept->Flops = S.Flops;
  Kept->BeginRos = S.BeginRos;
  Kept->EndRos = S.EndRos;
  __atomic_store_n(&Kept->What, SummaryRecord | bits(S.Result, S.Outcome),
                   __ATOMIC_RELEASE);
}

SlotPair *LogFile::newPair(Thread &T) {
  std::lock_guard<std::mutex> Guard(SystemLock);
  if (!LiveNext ||
      LiveEnd - LiveNext < static_cast<ptrdiff_t>(sizeof(SlotPair))) {
    char *Chunk = newChunk(Live, T.Number, 0, 0);
    if (!Chunk)
      return nullptr;
    LiveNext = Chunk + ChunkHeaderBytes;
    LiveEnd = Chunk + ChunkBytes;
  }
  char *Pair = LiveNext;
  LiveNext += sizeof(SlotPair);
  return reinterpret_cast<SlotPair *>(Pair);
}

} // namespace tpc
