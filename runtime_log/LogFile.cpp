//===- LogFile.cpp --------------------------------------------------------===//
#include "LogFile.h"

#include "Ros.h"

#include <algorithm>
#include <cstring>
#include <utility>

namespace tpc {

using namespace layout;

std::atomic<bool> TimeIsSimulated{false};

static constexpr size_t LongestKey = 4096;

LogFile *LogFile::open(const Config &C, SegmentName *Of, std::string &Why) {
  std::optional<NewFile> New = NewFile::create(C, Of, Why);
  if (!New)
    return nullptr;
  auto *File = new LogFile(C, *New);
  if (File->Space.grow(Why)) {
    File->setNode(rosNodeName());
    if (New->publish(Why)) {
      File->Space.touch();
      File->sync();
      return File;
    }
  }
  Why = New->Path + ": " + Why;
  New->discard();
  delete File;
  return nullptr;
}

void LogFile::setNode(const char *Name) {
  layout::Header &Header = Space.header();
  if (!*Name || Header.Node[0])
    return;
  size_t Length = std::min(std::strlen(Name), sizeof(Header.Node) - 1);
  std::memcpy(Header.Node + 1, Name + 1, Length - 1);
  __atomic_store_n(&Header.Node[0], Name[0], __ATOMIC_RELEASE);
}

bool LogFile::nextChunk(Thread &T) {
  const LogFile *Before = T.File.load(std::memory_order_relaxed);
  if (Before == this && T.End) {
    T.Written += RecordsOfChunk;
    Records.fetch_add(RecordsOfChunk, std::memory_order_relaxed);
    Space.finish(T.End);
  } else if (Before != this) {
    T.Written = 0;
    T.Simulated = -1;
  }
  T.File.store(this, std::memory_order_relaxed);
  char *Chunk = Space.newChunk(Reports, T.Number, T.Written, T.Tid);
  if (!Chunk) {
    T.Next = T.End = nullptr;
    __atomic_fetch_add(&Space.header().NotRecorded, 1, __ATOMIC_RELAXED);
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

void LogFile::writeLate(Thread &T, const Site &S, uint32_t Bits, int64_t Steady,
                        int64_t Simulated, double Compared, double Threshold) {
  if ((T.File.load(std::memory_order_relaxed) != this || T.Next == T.End) &&
      !nextChunk(T))
    return;
  if (Simulated != T.Simulated) {
    T.Simulated = Simulated;
    put(*T.Next++, SimulatedRecord, 0, Steady, Simulated, INT64_C(0));
    if (T.Next == T.End && !nextChunk(T))
      return;
  }
  put(*T.Next++, ReportRecord | Bits, S.Number, Steady, Compared, Threshold);
}

Record *LogFile::systemRecords(uint32_t Count) {
  if (!SystemNext || SystemEnd - SystemNext < static_cast<ptrdiff_t>(Count)) {
    if (SystemNext) {
      // The unused rest counts as used: the number of a record gives its place.
      SystemWritten += RecordsOfChunk;
      Space.finish(SystemEnd);
    }
    char *Chunk = Space.newChunk(System, 0, SystemWritten, 0);
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

/// Writes a record of kind \p What with \p Text, whose rest follows in as many
/// blocks as it needs. SystemLock is held.
bool LogFile::writeText(uint32_t What, uint32_t Site, const std::string &Text) {
  size_t Length = std::min(Text.size(), LongestKey);
  size_t InHead = std::min(Length, sizeof(Record::Text));
  auto Blocks =
      static_cast<uint32_t>((Length - InHead + RecordBytes - 1) / RecordBytes);
  Record *R = systemRecords(1 + Blocks);
  if (!R)
    return false;
  std::memcpy(R->Text, Text.data(), InHead);
  std::memcpy(R + 1, Text.data() + InHead, Length - InHead);
  R->Site = Site;
  R->Steady = static_cast<int64_t>(Length);
  __atomic_store_n(&R->What, What, __ATOMIC_RELEASE);
  return true;
}

void LogFile::announceLocked(Site &S) {
  if (S.WrittenTo.load(std::memory_order_relaxed) != this &&
      writeText(SiteRecord, S.Number, S.Key))
    S.WrittenTo.store(this, std::memory_order_relaxed);
}

void LogFile::write(const ReadName &N) {
  std::lock_guard<std::mutex> Guard(SystemLock);
  writeText(NameRecord, 0, N.Text);
}

/// Steady and real time at one instant: of four readings the one that was
/// interrupted least.
static std::pair<int64_t, int64_t> bothClocks() {
  int64_t Least = INT64_MAX, Steady = 0, Real = 0;
  for (int Try = 0; Try != 4; ++Try) {
    int64_t Before = Clock::now(), Now = Clock::real(), Took = Clock::now();
    Took -= Before;
    if (Took >= Least)
      continue;
    Least = Took;
    Steady = Before + Took / 2;
    Real = Now;
  }
  return {Steady, Real};
}

void LogFile::sync() {
  std::lock_guard<std::mutex> Guard(SystemLock);
  if (Record *R = systemRecords(1)) {
    auto [Steady, Real] = bothClocks();
    Space.header().Counter = Clock::usesCounter();
    put(*R, SyncRecord, 0, Steady, Real, rosNow());
  }
}

void LogFile::writePolicy(const Config &C) {
  std::lock_guard<std::mutex> Guard(SystemLock);
  if (Record *R = systemRecords(1))
    put(*R, PolicyRecord, static_cast<uint32_t>(C.Policy), Clock::now(),
        static_cast<int64_t>(C.PeriodNs), INT64_C(0));
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
  Kept->Seen = S.IsLight ? S.Seen : 0;
  Kept->IsAbout = S.IsAbout;
  Kept->BeginRos = S.BeginRos;
  Kept->EndRos = S.EndRos;
  __atomic_store_n(&Kept->What, SummaryRecord | bits(S.Result, S.Outcome),
                   __ATOMIC_RELEASE);
}

SlotPair *LogFile::newPair(Thread &T) {
  std::lock_guard<std::mutex> Guard(SystemLock);
  if (!LiveNext ||
      LiveEnd - LiveNext < static_cast<ptrdiff_t>(sizeof(SlotPair))) {
    char *Chunk = Space.newChunk(Live, T.Number, 0, 0);
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
