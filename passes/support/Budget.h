//===- Budget.h - Limits on time and memory -------------------------------===//
//
// Does not depend on LLVM. The loops of an analysis ask whether the budget is
// spent and, if so, end with what they have; LinkUnit then discards the
// findings and leaves the link unit unchanged. A single call into LLVM is not
// interrupted.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_BUDGET_H
#define TPC_BUDGET_H

#include <cstdint>
#include <string>

namespace tpc {

/// The budget of the analyses that this thread runs during its lifetime.
class Budget {
public:
  /// \p MaxSeconds of processor time of this thread, so that a busy machine
  /// makes no difference, and \p MaxMemory MiB more than the process uses now;
  /// 0 is no limit.
  Budget(unsigned MaxSeconds, unsigned MaxMemory);
  ~Budget();
  Budget(const Budget &) = delete;
  Budget &operator=(const Budget &) = delete;

  /// True once the budget of the thread is spent; false if it has none. Cheap
  /// enough for loops: reads the clock only now and then.
  static bool isSpent() {
    return Current && (Current->Spent ||
                       (++Current->Asked % LookEvery == 0 && Current->look()));
  }

  /// Which limit was exceeded, as a message; empty if none was.
  std::string why();

private:
  static constexpr unsigned LookEvery = 128;
  bool look();

  static thread_local Budget *Current;
  Budget *Outer;
  unsigned MaxSeconds, MaxMemory;
  double SecondsBefore, MemoryBefore;
  uint32_t Asked = 0;
  bool Spent = false;
  std::string Why;
};

} // namespace tpc

#endif // TPC_BUDGET_H
