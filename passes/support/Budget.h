//===- Budget.h - Limits on time and memory -------------------------------===//
//
// Does not depend on LLVM. The loops of an analysis ask whether the budget is
// spent and, if so, end with what they have. Each stage of the analysis gets a
// share, so that the stages after it can use what it has found: an analysis
// that is too expensive finds less, not nothing. A single call into LLVM is not
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

  /// Limits what the thread does during its lifetime to a fraction of what is
  /// left of the budget, but at least to a twentieth of all of it.
  class Share {
  public:
    explicit Share(double Fraction);
    ~Share();
    Share(const Share &) = delete;
    Share &operator=(const Share &) = delete;

  private:
    double Before = 1;
  };

  /// True once the budget of the thread, or the current share of it, is spent;
  /// false if it has none. Cheap enough for loops: reads the clock only now and
  /// then.
  static bool isSpent() {
    return Current && (Current->Spent ||
                       (++Current->Asked % LookEvery == 0 && Current->look()));
  }

  /// Spends what is left of the current share.
  static void spend() {
    if (Current) {
      Current->Spent = true;
      Current->leaveOut();
    }
  }

  /// How much of the budget is used, of time or of memory, whichever is more;
  /// above 1 if it is exceeded.
  double used() const;

  /// Which limit ended some stage early, as a message; empty if none did.
  const std::string &why() const { return Why; }
  /// For why(): something was left out because the budget would not suffice.
  void leaveOut();

private:
  static constexpr unsigned LookEvery = 128;
  bool look();
  double usedTime() const;
  double usedMemory() const;

  static thread_local Budget *Current;
  Budget *Outer;
  unsigned MaxSeconds, MaxMemory;
  double SecondsBefore, MemoryBefore;
  double End = 1; ///< of the current share, as a fraction of the budget
  uint32_t Asked = 0;
  bool Spent = false;
  std::string Why;
};

} // namespace tpc

#endif // TPC_BUDGET_H
