//===- ReadNames.h - Full names of parameters -----------------------------===//
//
// Before a read of a parameter, instrumented code calls log_read, which
// resolves the name as roscpp does and keeps it here. The helper thread gives
// each name of each read to the sink once, and again from time to time to a
// sink whose readers may come later.
//
// If objects of one class read a parameter under different names, it also gives
// which object is which: the objects that compare are numbered, and a number is
// given with each name that was read in the object, and with each key that it
// evaluates.
//
// If the process has several nodes, it also gives the node of each key whose
// evaluations are not those of the node that the process is named after.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_READNAMES_H
#define TPC_READNAMES_H

#include "NodeRanges.h"
#include "Sink.h"

#include <atomic>
#include <cstdint>
#include <map>
#include <mutex>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace tpc {

struct Site;

class ReadNames {
public:
  static constexpr size_t Most = 10'000;
  static constexpr int64_t FirstAgainNs = 1'000'000'000;
  static constexpr int64_t LastAgainNs = 32'000'000'000;

  /// The names of this process. Never destroyed.
  static ReadNames &all();

  /// Keeps \p Name for the read \p Key, from any thread. Beyond Most names
  /// nothing is kept, with one warning.
  /// It was read in the object at \p Object, of \p Size bytes, unless that is
  /// null, and of \p Node if that is one of several in this process.
  void add(const char *Key, const std::string &Name, const void *Object,
           uint64_t Size, const std::string &Node = {});

  /// Keeps that \p S has the evaluations of \p Object. Beyond Most such facts
  /// about objects nothing is kept, with one warning.
  void addObject(Site &S, const void *Object);

  /// The node \p Node was made, in the object at \p Object. If another node
  /// was there before, the sites of its objects are left to them.
  void addNode(const std::string &Node, const void *Object, uint64_t Size);

  /// The name of the node that \p Object is, or belongs to; empty if it is not
  /// known.
  std::string nodeOf(const void *Object);

  /// Gives \p To the names that it has not got; all of them if it is another
  /// sink than before, and again after 1 s, 2 s and so on up to every 32 s.
  void give(Sink &To, int64_t Now);

  /// The next give() gives all names: the sink writes to a new file.
  void startAgain();

  /// Whether give() may have something to do.
  bool any() const { return Any.load(std::memory_order_relaxed); }

  /// Call before and after a fork.
  void lock() { Lock.lock(); }
  void unlock() { Lock.unlock(); }

private:
  struct Reader {
    uintptr_t Begin, End;
    const std::string *Name; ///< in Known
    bool operator<(const Reader &R) const {
      return std::tie(Begin, End, Name) < std::tie(R.Begin, R.End, R.Name);
    }
  };

  const std::string *keep(std::string Text, size_t &Count);
  void tell(const std::string &Of, uint32_t Object);
  void tellOf(const Reader &R);
  void tellNode(Site &S, const void *Object);
  void tellNodes(const void *Object, uint64_t Size);
  void forget(uintptr_t Begin, uintptr_t End);
  void warnOfObjects();

  std::mutex Lock; ///< for everything that follows
  /// `KEY,NAME`, and what is told of objects. Its nodes stay where they are.
  std::set<std::string, std::less<>> Known;
  std::vector<const std::string *> InOrder;
  const Sink *Given = nullptr;
  size_t GivenCount = 0;
  int64_t AllGivenAt = 0, AgainNs = FirstAgainNs;
  size_t NameCount = 0, ObjectCount = 0; ///< in Known
  bool IsFull = false;                   ///< of names
  bool IsFullOfObjects = false;
  std::map<std::string, const std::string *, std::less<>> FirstNames;
  std::set<Reader> Readers;
  std::map<uintptr_t, uint32_t> Objects; ///< those that compare, by address
  uint32_t LastObject = 0;               ///< the number of the newest one
  std::vector<std::pair<Site *, uintptr_t>> Compared; ///< sites, of objects
  NodeRanges Nodes;
  bool TellsObjects = false; ///< a read has read under different names
  std::atomic<bool> Any{false};
};

/// The full name of the parameter \p Name for the ros::NodeHandle \p Handle, or
/// for the node if that is null; empty if there is none.
std::string resolveName(const void *Handle, const std::string &Name);

} // namespace tpc

#endif // TPC_READNAMES_H
