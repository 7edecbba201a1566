//===- TopicStore.cpp -----------------------------------------------------===//
#include "TopicStore.h"

#include "Clock.h"
#include "LogFile.h"
#include "Modes.h"

#include <cstring>
#include <sys/mman.h>

namespace tpc {

static constexpr uint32_t BlockEntries = 4096;
static constexpr size_t BlockBytes = size_t(512) * 1024;

/// Stands before each entry in a block; a summary follows.
namespace {
struct Head {
  int64_t Ns;
  double Compared, Threshold;
  Site *Of;
  uint64_t Evaluations; ///< for a summary
  int64_t Steady;       ///< of a report
  uint32_t Length;      ///< of the summary
  bool Guessed;
  LineKind Kind;
  bool Result, Outcome;
};
} // namespace

/// Calls \p Visit(Head, Summary or null) for each entry of a block.
template <typename F> static void forEach(const TopicStore::Block &B, F Visit) {
  const std::string_view Data = B.data();
  for (size_t At = 0; At < Data.size();) {
    Head H;
    std::memcpy(&H, Data.data() + At, sizeof(H));
    Summary S;
    if (H.Length)
      std::memcpy(&S, Data.data() + At + sizeof(H), sizeof(S));
    Visit(H, H.Length ? &S : nullptr);
    At += sizeof(H) + H.Length;
  }
}

TopicStore::Block::Block(Block &&From) noexcept { *this = std::move(From); }

TopicStore::Block &TopicStore::Block::operator=(Block &&From) noexcept {
  std::swap(Data, From.Data);
  std::swap(Size, From.Size);
  std::swap(Entries, From.Entries);
  return *this;
}

TopicStore::Block::~Block() {
  if (Data)
    munmap(Data, BlockBytes);
}

char *TopicStore::Block::allocate(size_t Length) {
  if (!Data) {
    void *New = mmap(nullptr, BlockBytes, PROT_READ | PROT_WRITE,
                     MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (New == MAP_FAILED)
      return nullptr;
    Data = static_cast<char *>(New);
  }
  if (Entries == BlockEntries || BlockBytes - Size < Length)
    return nullptr;
  char *Place = Data + Size;
  Size += Length;
  ++Entries;
  return Place;
}

/// Space for an entry of \p Length bytes; null if there is no memory.
char *TopicStore::allocate(size_t Length) {
  char *Place =
      Used ? Blocks[(First + Used - 1) % MostBlocks].allocate(Length) : nullptr;
  if (!Place) {
    if (Used == MostBlocks)
      evict();
    Place = Blocks[(First + Used++) % MostBlocks].allocate(Length);
  }
  Bytes += Place ? Length : 0;
  return Place;
}

void TopicStore::add(Time When, const Report &R) {
  Site *Of = sites().find(R.Key);
  if (!Of)
    return;
  const Head H{
      When.Ns, R.Compared,   R.Threshold,      Of,       1,        Clock::now(),
      0,       When.Guessed, LineKind::Report, R.Result, R.Outcome};
  if (char *To = allocate(sizeof(H))) {
    std::memcpy(To, &H, sizeof(H));
    return;
  }
  ++Of->Evicted.Count;
  ++DroppedInAll;
  HasEvicted = true;
}

void TopicStore::add(Time When, const Summary &S, bool MayBeShort) {
  const bool IsShort = S.IsLight && MayBeShort;
  const Head H{When.Ns,
               S.Compared,
               S.Threshold,
               &sites()[S.Site],
               S.Count,
               0,
               sizeof(S),
               When.Guessed,
               IsShort ? LineKind::ShortSummary : LineKind::Summary,
               S.Result,
               S.Outcome};
  if (char *To = allocate(sizeof(H) + H.Length)) {
    std::memcpy(To, &H, sizeof(H));
    std::memcpy(To + sizeof(H), &S, sizeof(S));
    return;
  }
  account(S.Key, DropReason::Stopped, S.Count, 0);
}

void TopicStore::add(const Dropped &D) {
  account(D.Key, D.Why, D.Count, D.Flops);
}

void TopicStore::account(const std::string &Key, DropReason Why, uint64_t Count,
                         uint64_t Flops) {
  auto &[Counted, CountedFlops] = Accounts[{Key, Why}];
  Counted += Count;
  CountedFlops += Flops;
  DroppedInAll += Count;
}

/// Drops the oldest block to make space. Of the flops in it, those are counted
/// that the dropped reports show.
void TopicStore::evict() {
  Block &Oldest = Blocks[First];
  forEach(Oldest, [this](const Head &H, const Summary *) {
    Site &Of = *H.Of;
    Of.Evicted.Count += H.Evaluations;
    DroppedInAll += H.Evaluations;
    if (H.Kind == LineKind::Report) {
      Of.Evicted.Flops += Of.LastEvicted >= 0 && Of.LastEvicted != H.Result;
      Of.LastEvicted = H.Result;
    }
  });
  HasEvicted = true;
  Bytes -= Oldest.data().size();
  Oldest.clear();
  First = (First + 1) % MostBlocks;
  --Used;
}

TopicStore::Batch TopicStore::takeAll() {
  Batch All;
  for (; Used; First = (First + 1) % MostBlocks, --Used)
    All.Blocks.push_back(std::move(Blocks[First]));
  if (HasEvicted)
    for (uint32_t Number = 1; Number <= sites().size(); ++Number) {
      Site &S = sites()[Number];
      S.LastEvicted = -1;
      const uint64_t Count = S.Evicted.Count.exchange(0);
      if (!Count)
        continue;
      auto &Counts = Accounts[{S.Key, DropReason::Stopped}];
      Counts.first += Count;
      Counts.second += S.Evicted.Flops.exchange(0);
    }
  HasEvicted = false;
  All.Accounts = std::move(Accounts);
  All.Names = std::move(Names);
  All.DroppedInAll = DroppedInAll;
  Accounts.clear();
  Names.clear();
  Bytes = 0;
  return All;
}

uint64_t TopicStore::giveUp() {
  const uint64_t Before = DroppedInAll;
  while (Used)
    evict();
  return DroppedInAll - Before;
}

const char *prefixOf(LineKind K) {
  switch (K) {
  case LineKind::Report:
    return "threshold_information:";
  case LineKind::Summary:
  case LineKind::ShortSummary:
    return "threshold_summary:";
  case LineKind::Dropped:
    return "threshold_dropped:";
  case LineKind::Name:
    return "threshold_name:";
  }
  return "";
}

/// What the text of a short summary begins with.
static std::string spanOf(const Summary &S) {
  return seconds(S.BeginRos, 7) + ';' + seconds(S.EndRos, 7) + '\n';
}

void forEachLine(const TopicStore::Batch &B, int64_t Now, bool Simulated,
                 const std::function<void(LineKind, int64_t, std::string_view,
                                          const char *)> &Visit) {
  for (const TopicStore::Block &Part : B.Blocks)
    forEach(Part, [&](const Head &H, const Summary *S) {
      const int64_t Ns = H.Guessed && Simulated ? 0 : H.Ns;
      const char *Node = H.Of->Node.load(std::memory_order_acquire);
      if (H.Kind == LineKind::Report)
        Visit(H.Kind, Ns,
              format(Report{H.Of->Key.c_str(), H.Result, H.Compared,
                            H.Threshold, H.Outcome}),
              Node);
      else
        Visit(H.Kind, Ns,
              H.Kind == LineKind::Summary ? format(*S)
                                          : spanOf(*S) + formatShort(*S),
              Node);
    });
  for (const auto &[Of, Counts] : B.Accounts)
    Visit(LineKind::Dropped, Now,
          format(Dropped{Of.first.c_str(), 0, Counts.first, Counts.second,
                         Of.second}),
          nullptr);
  for (const std::string &Name : B.Names)
    Visit(LineKind::Name, Now, Name, nullptr);
}

std::vector<TopicStore::Lines> linesOf(const TopicStore::Batch &B, int64_t Now,
                                       bool Simulated, size_t MessageBytes) {
  std::vector<TopicStore::Lines> Found(1);
  std::string Span; ///< of the short summaries that follow in the message
  forEachLine(
      B, Now, Simulated,
      [&](LineKind Kind, int64_t Ns, std::string_view Text, const char *) {
        if (Found.back().Text.size() >= MessageBytes) {
          Found.emplace_back();
          Span.clear();
        }
        TopicStore::Lines &Last = Found.back();
        if (Kind == LineKind::ShortSummary) {
          const size_t End = Text.find('\n');
          if (Text.substr(0, End) != Span) {
            Span = Text.substr(0, End);
            (Last.Text += "\n@") += Span;
          }
          (Last.Text += "\n~") += Text.substr(End + 1);
          return;
        }
        ((Last.Text += '\n') += seconds(Ns, 7)) += ',';
        if (Kind == LineKind::Report)
          ++Last.Reports;
        else
          Last.Text += prefixOf(Kind);
        Last.Text += Text;
      });
  if (Found.back().Text.empty())
    Found.pop_back();
  return Found;
}

void write(const TopicStore::Batch &B, uint32_t Bits, bool Simulated, Thread &T,
           LogFile &To) {
  for (const TopicStore::Block &Part : B.Blocks)
    forEach(Part, [&](const Head &H, const Summary *S) {
      To.announce(*H.Of);
      if (S)
        return To.write(*S);
      const int64_t Sim = H.Guessed ? 0 : H.Ns;
      To.writeLate(T, *H.Of, Bits | layout::bits(H.Result, H.Outcome), H.Steady,
                   Simulated ? Sim : -1, H.Compared, H.Threshold);
    });
  for (const auto &[Of, Counts] : B.Accounts) {
    Site *S = Of.first.empty() ? nullptr : sites().find(Of.first.c_str());
    if (S)
      To.announce(*S);
    To.write(Dropped{Of.first.c_str(), S ? S->Number : 0, Counts.first,
                     Counts.second, Of.second});
  }
}

} // namespace tpc
