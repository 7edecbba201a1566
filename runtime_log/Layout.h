//===- Layout.h - The layout of the binary file ---------------------------===//
//
// docs/reference/formats.md describes it in words. Little endian; unwritten
// bytes are zero. The field `What` of a record is written last, so that a
// record with one is complete even if the process ends suddenly.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_LAYOUT_H
#define TPC_LAYOUT_H

#include <cstddef>
#include <cstdint>

namespace tpc::layout {

constexpr uint32_t HeaderBytes = 4096;
constexpr uint32_t RecordBytes = 32;
constexpr uint32_t ChunkBytes = 65536;
constexpr uint32_t ChunkHeaderBytes = 64;
constexpr uint32_t RecordsOfChunk =
    (ChunkBytes - ChunkHeaderBytes) / RecordBytes;

struct Header {
  char Magic[8];
  uint32_t HeaderSize, RecordSize, ChunkSize;
  uint32_t Pid;
  int64_t Steady, Real;
  uint32_t State;
  uint32_t Counter;
  uint64_t NotRecorded;
  uint32_t Parent;
  uint32_t Segment; ///< its number in a ring, from 1; 0: it is no ring's
  char Node[256];
  char Host[256];
  char Program[1024];
};
static_assert(offsetof(Header, Node) == 64 && sizeof(Header) <= HeaderBytes);

enum State : uint32_t { Open = 0, Closed = 1, Stopped = 2 };

enum ChunkKind : uint32_t { Reports = 1, System = 2, Live = 3 };

struct ChunkHeader {
  uint32_t Kind;
  uint32_t Thread;
  uint64_t First;
  uint64_t Tid;
  uint64_t Spare[5];
};
static_assert(sizeof(ChunkHeader) == ChunkHeaderBytes);

enum Kind : uint32_t {
  ReportRecord = 1,
  SiteRecord = 2,
  SyncRecord = 3,
  SimulatedRecord = 4,
  SummaryRecord = 5,
  DroppedRecord = 6,
  PolicyRecord = 7,
  NameRecord = 8
};

constexpr uint32_t ResultBit = 1U << 8;
constexpr uint32_t OutcomeBit = 1U << 9;
constexpr uint32_t EdgeBit = 1U << 10;
constexpr uint32_t ReasonShift = 16;

constexpr uint32_t bits(bool Result, bool Outcome) {
  return (Result ? ResultBit : 0) | (Outcome ? OutcomeBit : 0);
}

struct Record {
  uint32_t What;
  uint32_t Site;
  int64_t Steady; ///< for a site or a name: the length of its text
  union {
    double Numbers[2]; ///< for a report: compared value and threshold
    int64_t Integers[2];
    char Text[16];
  };
};
static_assert(sizeof(Record) == RecordBytes);

/// A summary, and the fields of it that are kept up to date in a live chunk.
struct Summary {
  uint32_t What;
  uint32_t Site;
  int64_t BeginSteady;
  double Compared, Threshold;
  int64_t EndSteady;
  uint32_t Period;
  uint32_t Thread;
  uint64_t Count, Odd, Far;
  double DiffMin, DiffMax, DiffSum, AbsSum, Low, High;
  uint64_t Flops;
  int64_t BeginRos, EndRos;
  /// Of the policy `light`: how many evaluations were inspected, and whether
  /// the counts are estimates.
  uint64_t Seen, IsAbout;
};
static_assert(sizeof(Summary) == size_t(5) * RecordBytes);

struct Slot {
  Summary Kept;
  uint64_t Begun;
  uint64_t Spare[3];
};
static_assert(sizeof(Slot) == 192);

constexpr uint32_t SlotsOfChunk =
    (ChunkBytes - ChunkHeaderBytes) / sizeof(Slot);

} // namespace tpc::layout

#endif // TPC_LAYOUT_H
