//===- TopicStore.cpp -----------------------------------------------------===//
#include "TopicStore.h"

#include <cstring>
#include <string_view>

namespace tpc {

static constexpr size_t MostBlocks = 16;
static constexpr uint32_t BlockEntries = 4096;
/// A block ends here even with few entries, so that long keys cannot make it
/// large.
static constexpr size_t BlockBytes = size_t(512) * 1024;

/// Stands before each entry in a block. The key with its NUL follows and, for a
/// summary, the rest of its text.
namespace {
struct Head {
  int64_t Ns;
  double Compared, Threshold;
  uint64_t Evaluations; ///< for a summary
  uint32_t Length;      ///< of everything that follows
  bool Guessed, IsReport, Result, Outcome;
};
} // namespace

/// Calls \p Visit(Head, Key, Text) for each entry of a block.
template <typename F> static void forEach(const TopicStore::Block &B, F Visit) {
  for (size_t At = 0; At < B.Data.size();) {
    Head H;
    std::memcpy(&H, B.Data.data() + At, sizeof(H));
    const char *Key = B.Data.data() + At + sizeof(H);
    const char *Text = Key + std::strlen(Key) + 1;
    Visit(H, Key, std::string_view(Text, Key + H.Length - Text));
    At += sizeof(H) + H.Length;
  }
}

char *TopicStore::allocate(size_t Length) {
  if (Blocks.empty() || Blocks.back().Entries >= BlockEntries ||
      Blocks.back().Data.size() >= BlockBytes) {
    if (Blocks.size() == MostBlocks)
      evict();
    Blocks.emplace_back();
  }
  Block &Last = Blocks.back();
  const size_t At = Last.Data.size();
  Last.Data.resize(At + Length);
  ++Last.Entries;
  Bytes += Length;
  return Last.Data.data() + At;
}

void TopicStore::add(Time When, const Report &R) {
  const size_t KeyBytes = std::strlen(R.Key) + 1;
  const Head H{When.Ns,
               R.Compared,
               R.Threshold,
               1,
               static_cast<uint32_t>(KeyBytes),
               When.Guessed,
               true,
               R.Result,
               R.Outcome};
  char *To = allocate(sizeof(H) + KeyBytes);
  std::memcpy(To, &H, sizeof(H));
  std::memcpy(To + sizeof(H), R.Key, KeyBytes);
}

void TopicStore::add(Time When, const Summary &S) {
  const std::string Text = format(S);
  const size_t KeyBytes = std::strlen(S.Key) + 1;
  const Head H{When.Ns,
               S.Compared,
               S.Threshold,
               S.Count,
               static_cast<uint32_t>(KeyBytes + Text.size()),
               When.Guessed,
               false,
               S.Result,
               S.Outcome};
  char *To = allocate(sizeof(H) + H.Length);
  std::memcpy(To, &H, sizeof(H));
  std::memcpy(To + sizeof(H), S.Key, KeyBytes);
  std::memcpy(To + sizeof(H) + KeyBytes, Text.data(), Text.size());
}

void TopicStore::add(const Dropped &D) {
  account(D.Key, D.Why, D.Count, D.Flops);
}

void TopicStore::account(std::string Key, DropReason Why, uint64_t Count,
                         uint64_t Flops) {
  auto &[Counted, CountedFlops] = Accounts[{std::move(Key), Why}];
  Counted += Count;
  CountedFlops += Flops;
  DroppedInAll += Count;
}

/// Drops the oldest block to make space. Of the flops in it, those are counted
/// that the dropped reports show.
void TopicStore::evict() {
  const Block Oldest = std::move(Blocks.front());
  Blocks.pop_front();
  Bytes -= Oldest.Data.size();
  forEach(Oldest, [this](const Head &H, const char *Key, std::string_view) {
    bool Flop = false;
    if (H.IsReport) {
      const auto Last = LastEvicted.find(std::string_view(Key));
      Flop = Last != LastEvicted.end() && Last->second != H.Result;
      if (Last == LastEvicted.end())
        LastEvicted.emplace(Key, H.Result);
      else
        Last->second = H.Result;
    }
    account(Key, DropReason::Stopped, H.Evaluations, Flop);
  });
}

TopicStore::Batch TopicStore::takeAll() {
  Batch All{std::move(Blocks), std::move(Accounts), DroppedInAll};
  Blocks.clear();
  Accounts.clear();
  LastEvicted.clear();
  Bytes = 0;
  return All;
}

uint64_t TopicStore::giveUp() {
  const uint64_t Before = DroppedInAll;
  while (!Blocks.empty())
    evict();
  return DroppedInAll - Before;
}

std::vector<TopicStore::Lines> linesOf(const TopicStore::Batch &B, int64_t Now,
                                       bool Simulated, size_t MessageBytes) {
  std::vector<TopicStore::Lines> Found(1);
  const auto Add = [&](int64_t Ns, std::string_view What, std::string_view Text,
                       bool IsReport) {
    if (Found.back().Text.size() >= MessageBytes)
      Found.emplace_back();
    TopicStore::Lines &Last = Found.back();
    Last.Text += '\n';
    Last.Text += seconds(Ns, 7);
    Last.Text += ',';
    Last.Text += What;
    Last.Text += Text;
    Last.Reports += IsReport;
  };
  for (const TopicStore::Block &Part : B.Blocks)
    forEach(Part, [&](const Head &H, const char *Key, std::string_view Text) {
      const int64_t Ns = H.Guessed && Simulated ? 0 : H.Ns;
      if (H.IsReport)
        Add(Ns, "",
            format(Report{Key, H.Result, H.Compared, H.Threshold, H.Outcome}),
            true);
      else
        Add(Ns, "threshold_summary:", Text, false);
    });
  for (const auto &[Of, Counts] : B.Accounts)
    Add(Now, "threshold_dropped:",
        format(Dropped{Of.first.c_str(), 0, Counts.first, Counts.second,
                       Of.second}),
        false);
  if (Found.back().Text.empty())
    Found.pop_back();
  return Found;
}

} // namespace tpc
