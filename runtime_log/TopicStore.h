//===- TopicStore.h - What waits to be sent on the topic ------------------===//
//
// No ROS in here: bytes in, text out. The lines are those of
// docs/reference/formats.md.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_TOPICSTORE_H
#define TPC_TOPICSTORE_H

#include "Report.h"

#include <deque>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace tpc {

/// Keeps reports and summaries in order, the newest 65,536 of them in blocks of
/// 4,096; what makes room for others is counted for each key.
class TopicStore {
public:
  /// ROS time. Guessed: the wall's, before it was known which time holds.
  struct Time {
    int64_t Ns;
    bool Guessed;
  };

  /// One message's lines, and how many of them are reports.
  struct Lines {
    std::string Text;
    uint64_t Reports = 0;
  };

  void add(Time When, const Report &R);
  void add(Time When, const Summary &S);
  void add(const Dropped &D);

  size_t bytes() const { return Bytes; }

  struct Block {
    std::string Data;
    uint32_t Entries = 0;
  };

  /// What was in a store, to be made into text without holding its lock.
  struct Batch {
    std::deque<Block> Blocks;
    std::map<std::pair<std::string, DropReason>, std::pair<uint64_t, uint64_t>>
        Accounts;
    uint64_t DroppedInAll = 0; ///< since the store was made
  };

  /// Hands out all that waits; the store is empty then, its counts go on.
  Batch takeAll();

  /// Counts all that waits as dropped; returns how many evaluations those are.
  uint64_t giveUp();

private:
  char *room(size_t Length);
  void account(std::string Key, DropReason Why, uint64_t Count, uint64_t Flops);
  void evict();

  std::deque<Block> Blocks;
  decltype(Batch::Accounts) Accounts;
  std::map<std::string, bool, std::less<>> LastEvicted;
  size_t Bytes = 0;
  uint64_t DroppedInAll = 0;
};

/// The lines of \p B, in messages of about \p MessageBytes.
///
/// \param Now       ROS time of the accounts of what was dropped.
/// \param Simulated times that were guessed are not those of the node: they
///                  are written as 0, which readers take as not known.
std::vector<TopicStore::Lines> linesOf(const TopicStore::Batch &B, int64_t Now,
                                       bool Simulated, size_t MessageBytes);

} // namespace tpc

#endif // TPC_TOPICSTORE_H
