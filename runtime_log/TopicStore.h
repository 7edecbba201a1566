//===- TopicStore.h - Reports that wait for the topic ---------------------===//
//
// Does not depend on ROS: bytes in, text out. docs/reference/formats.md defines
// the lines.
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

/// Keeps reports and summaries in order: the newest 65,536 in blocks of 4,096.
/// What is dropped to make space is counted for each key.
class TopicStore {
public:
  /// ROS time. Guessed: wall time, taken before it was known which time the
  /// node uses.
  struct Time {
    int64_t Ns;
    bool Guessed;
  };

  /// The lines of one message, and how many of them are reports.
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

  /// The contents of a store, taken out so that they can be formatted without
  /// its lock.
  struct Batch {
    std::deque<Block> Blocks;
    std::map<std::pair<std::string, DropReason>, std::pair<uint64_t, uint64_t>>
        Accounts;
    uint64_t DroppedInAll = 0; ///< since the store was created
  };

  /// Takes out everything that is waiting; the store is then empty, but its
  /// counts continue.
  Batch takeAll();

  /// Counts everything that is waiting as dropped; returns the number of
  /// evaluations.
  uint64_t giveUp();

private:
  char *allocate(size_t Length);
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
