//===- TopicStore.h - Reports that wait for the topic ---------------------===//
//
// Does not depend on ROS: bytes in, text out. docs/reference/formats.md defines
// the lines.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_TOPICSTORE_H
#define TPC_TOPICSTORE_H

#include "Report.h"

#include <functional>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace tpc {

class LogFile;
struct Thread;

/// Keeps reports and summaries in order: the newest 65,536 in blocks of 4,096.
/// What is dropped to make space is counted for each site.
///
/// add() of a report allocates nothing from the heap: a signal handler may
/// interrupt it and shut the node down, for which roscpp needs the heap.
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
  /// \p MayBeShort: a light summary takes the short form that a batch has.
  void add(Time When, const Summary &S, bool MayBeShort);
  void add(const Dropped &D);
  void add(const ReadName &N) { Names.insert(N.Text); }

  size_t bytes() const { return Bytes; }

  /// A stretch of entries, in memory that comes from the kernel.
  class Block {
  public:
    Block() = default;
    Block(Block &&From) noexcept;
    Block &operator=(Block &&From) noexcept;
    ~Block();

    /// Space for \p Length bytes more; null if it is full.
    char *allocate(size_t Length);
    void clear() { Size = Entries = 0; }
    std::string_view data() const { return {Data, Size}; }

  private:
    char *Data = nullptr;
    uint32_t Size = 0, Entries = 0;
  };

  /// The contents of a store, taken out so that they can be formatted without
  /// its lock.
  struct Batch {
    std::vector<Block> Blocks;
    std::map<std::pair<std::string, DropReason>, std::pair<uint64_t, uint64_t>>
        Accounts;
    std::set<std::string> Names; ///< `KEY,NAME` of parameters
    uint64_t DroppedInAll = 0;   ///< since the store was created
  };

  /// Takes out everything that is waiting; the store is then empty, but its
  /// counts continue.
  Batch takeAll();

  /// Counts everything that is waiting as dropped; returns the number of
  /// evaluations.
  uint64_t giveUp();

private:
  static constexpr size_t MostBlocks = 16;

  char *allocate(size_t Length);
  void evict();
  void account(const std::string &Key, DropReason Why, uint64_t Count,
               uint64_t Flops);

  Block Blocks[MostBlocks]; ///< a ring
  size_t First = 0, Used = 0;
  decltype(Batch::Accounts) Accounts;
  decltype(Batch::Names) Names;
  bool HasEvicted = false; ///< since the last batch
  size_t Bytes = 0;
  uint64_t DroppedInAll = 0;
};

/// What a line begins with, after its time; a report has nothing there in a
/// batch.
enum class LineKind : uint8_t { Report, Summary, ShortSummary, Dropped, Name };
const char *prefixOf(LineKind K);

/// Calls \p Visit(kind, ROS time in ns, text, node) for everything in \p B; the
/// node is that of its site (Sites.h), or null.
///
/// \param Now       ROS time of the accounts of what was dropped.
/// \param Simulated times that were guessed are not those of the node: they
///                  are 0, which readers take as not known.
void forEachLine(const TopicStore::Batch &B, int64_t Now, bool Simulated,
                 const std::function<void(LineKind, int64_t, std::string_view,
                                          const char *)> &Visit);

/// Writes everything in \p B to a file, as if \p T had reported it: with the
/// times that it had, each report with \p Bits. Names are not written.
void write(const TopicStore::Batch &B, uint32_t Bits, bool Simulated, Thread &T,
           LogFile &To);

/// The lines of \p B, in messages of about \p MessageBytes.
std::vector<TopicStore::Lines> linesOf(const TopicStore::Batch &B, int64_t Now,
                                       bool Simulated, size_t MessageBytes);

} // namespace tpc

#endif // TPC_TOPICSTORE_H
