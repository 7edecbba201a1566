//===- Report.h - Reports, and their text ---------------------------------===//
#ifndef TPC_REPORT_H
#define TPC_REPORT_H

#include <cstdint>
#include <string>

namespace tpc {

/// One evaluation.
struct Report {
  const char *Key;
  bool Result;
  double Compared;
  double Threshold;
  bool Outcome;
};

/// What the policy `edges` keeps of all evaluations of one site in one thread
/// and period. Diff is compared minus threshold; if it is not finite, an
/// evaluation only counts in Count, Flops and Odd.
struct Summary {
  const char *Key;
  uint32_t Site;
  uint32_t Thread;
  uint32_t Period;
  bool Result; ///< this and the next three belong to the last evaluation
  bool Outcome;
  double Compared;
  double Threshold;
  uint64_t Count;
  uint64_t Flops;
  uint64_t Far; ///< evaluations with |Diff| > 1e-4
  uint64_t Odd;
  double DiffMin, DiffMax, DiffSum;
  double AbsSum;    ///< of |Diff|
  double Low, High; ///< of all compared values and thresholds
  /// The span that contains all evaluations, in nanoseconds.
  int64_t BeginSteady, EndSteady;
  int64_t BeginRos, EndRos;

  // Of the policy `light` only.
  bool IsLight = false;
  /// Count or Flops are estimates: several threads share the site, or its flops
  /// were sampled.
  bool IsAbout = false;
  bool HasOneThreshold = false;
  /// How many evaluations were inspected. Far, Odd, DiffSum and AbsSum are
  /// scaled from those to Count, the extremes are of those.
  uint64_t Seen = 0;
  double Least = 0, Most = 0; ///< of the compared values
};

/// Why a report was dropped.
enum class DropReason : uint8_t {
  SiteCap = 1,
  ProcessCap = 2,
  Nested = 3, ///< made inside another report of the same thread
  Stopped = 4 ///< its sink accepts no more
};

const char *text(DropReason R);

/// The full name of the parameter that a read has read: `KEY,NAME`.
struct ReadName {
  const std::string &Text;
};

/// The reports of a site that were dropped since the previous Dropped for it.
/// Key is empty if the site is not known.
struct Dropped {
  const char *Key;
  uint32_t Site;
  uint64_t Count;
  uint64_t Flops;
  DropReason Why;
};

/// `KEY,RESULT,cmp:C,thresh:T,res:R` (docs/reference/formats.md). A number is
/// the shortest text that reads back as the same double.
std::string format(const Report &R);

/// The same with `,count:N,flops:F,diff:MIN;MAX;MEAN,abs:MEAN,range:LOW;HIGH,
/// far:N,odd:N,span:BEGIN;END` and, if not all were inspected, `,seen:N`; if
/// the counts are estimates, `,about` (docs/reference/formats.md).
std::string format(const Summary &S);

/// The same in one short line, without span (docs/reference/formats.md).
std::string formatShort(const Summary &S);

/// `KEY,count:N,flops:F,why:W`.
std::string format(const Dropped &D);

/// \p Ns nanoseconds as seconds with \p Decimals decimals, truncated.
std::string seconds(int64_t Ns, int Decimals);

} // namespace tpc

#endif // TPC_REPORT_H
