//===- Budget.h - What an analysis may take of the machine ----------------===//
//
// Free of LLVM. An analysis asks in its loops whether its budget is spent, and
// ends them with what it has if so; LinkUnit then throws the findings away and
// leaves the unit as it was. What one call into LLVM takes is not asked for.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_BUDGET_H
#define TPC_BUDGET_H

#include <cstdint>
#include <string>

namespace tpc {

/// The budget of the analyses that this thread runs while it lives.
class Budget {
public:
  /// \p MaxSeconds of this thread's processor time, so that a busy machine
  /// takes nothing away, and \p MaxMemory MiB more than the process has now;
  /// 0 is no limit.
  Budget(unsigned MaxSeconds, unsigned MaxMemory);
  ~Budget();
  Budget(const Budget &) = delete;
  Budget &operator=(const Budget &) = delete;

  /// True once the thread's budget is spent; false where it has none. Made to
  /// be called in loops: the clock is looked at now and then.
  static bool isSpent() {
    return Current && (Current->Spent ||
                       (++Current->Asked % LookEvery == 0 && Current->look()));
  }

  /// What was spent, for a message; empty as long as there is something left.
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
