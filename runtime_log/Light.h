//===- Light.h - The policy `light` ---------------------------------------===//
//
// The default. Each flop is reported, up to the caps. All evaluations of a site
// are counted, and a sample of them is summarised, once in a period. Between
// two samples the instrumented code only counts down (SiteWords.h), so a
// comparison in a hot loop costs about a nanosecond.
//
// No thread waits for another: a thread that finds a site in use by another for
// longer than a moment leaves its evaluation uninspected, and counts it.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_LIGHT_H
#define TPC_LIGHT_H

#include "Sink.h"
#include "SiteWords.h"
#include "Sites.h"
#include "Threads.h"

namespace tpc {

/// Records one evaluation, of \p Object if that is not null. \p Key is the key
/// that the instrumented code passed.
void light(Thread &T, Site &S, const Report &R, const char *Key,
           const void *Object);

/// Whether the evaluation needs only to be counted, and has been. For callers
/// of log_one that do not look at SiteWords themselves.
bool isPassedOver(const Site &S, bool Result);

/// Begins the first period for a new sink. With \p Forgets, what was counted
/// before is forgotten: it was while another policy held.
void beginLight(bool Forgets);

/// How many summaries a flush may pass on.
struct SummaryLimit {
  uint64_t Most = UINT64_MAX;
  /// Those of sites that have none for so long come first.
  int64_t OldestNs = INT64_MAX;
};

/// Ends a period: passes summaries to \p To and begins a new period. If there
/// are more than \p Limit allows, those with something new come first, then
/// those that have waited longest; the periods of the others become longer.
/// With \p IsEnd, there is no limit, and what has no sample is counted, too.
void flushLight(Sink &To, bool IsEnd, const SummaryLimit &Limit);

/// The next evaluation of each site is inspected: a ring has a new file.
void lookAgain();

/// The object of \p S is gone: what is made at its address counts elsewhere.
void releaseWords(const Site &S);

/// In the child of a fork, where only the calling thread exists.
void lightAfterFork();

} // namespace tpc

#endif // TPC_LIGHT_H
