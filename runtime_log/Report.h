//===- Report.h - What is reported, and its text --------------------------===//
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
/// and period. Diff is compared minus threshold; an evaluation where that is
/// not finite is in Count, Flops and Odd alone.
struct Summary {
  const char *Key;
  uint32_t Site;
  uint32_t Thread;
  uint32_t Period;
  bool Result; ///< this and the next three are of the last evaluation
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
  /// The span in which all the evaluations lie, in nanoseconds.
  int64_t BeginSteady, EndSteady;
  int64_t BeginRos, EndRos;
};

/// Why a report was not made.
enum class DropReason : uint8_t {
  SiteCap = 1,
  ProcessCap = 2,
  Nested = 3, ///< from within another report in the same thread
  Stopped = 4 ///< its sink takes no more
};

const char *text(DropReason R);

/// Reports of a site that were not made since the last such account of it. Key
/// is empty where it is not known of which.
struct Dropped {
  const char *Key;
  uint32_t Site;
  uint64_t Count;
  uint64_t Flops;
  DropReason Why;
};

/// `KEY,RESULT,cmp:C,thresh:T,res:R` (SPEC 5). Numbers are the shortest text
/// that reads back as the same double.
std::string format(const Report &R);

/// The same with `,count:N,flops:F,diff:MIN;MAX;MEAN,abs:MEAN,range:LOW;HIGH,
/// far:N,odd:N,span:BEGIN;END` (docs/reference/formats.md).
std::string format(const Summary &S);

/// `KEY,count:N,flops:F,why:W`.
std::string format(const Dropped &D);

/// `S.FFFFFFF` of nanoseconds: seconds with so many decimals, cut off.
std::string seconds(int64_t Ns, int Decimals);

} // namespace tpc

#endif // TPC_REPORT_H
