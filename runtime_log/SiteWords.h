//===- SiteWords.h - What instrumented code and the library share ---------===//
//
// An instrumented module has one of these for each comparison, each in a cache
// line of its own, and passes the address of Key to log_one. While the policy
// is `light`, the module's code calls log_one only if Left[outcome] is 0. If it
// is positive, the code decrements it instead; if negative, it does nothing.
// The words do not know objects: a comparison that calls log_one_of has none.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_SITEWORDS_H
#define TPC_SITEWORDS_H

#include <atomic>
#include <cstddef>
#include <cstdint>

namespace tpc {

struct alignas(64) SiteWords {
  std::atomic<int32_t> Left[2];
  char Key[56];
};
static_assert(sizeof(SiteWords) == 64 && offsetof(SiteWords, Key) == 8);

/// The values of tpc_reporting.
enum Reporting : char {
  ReportNone = 0,
  ReportAll = 1, ///< call log_one for each evaluation
  ReportFew = 2  ///< only if SiteWords::Left says so
};

/// The words that hold \p Key; null if it is in no registered module.
SiteWords *wordsOf(const char *Key);

} // namespace tpc

/// A module is loaded that has \p Count words from \p First on.
extern "C" __attribute__((visibility("default"))) void
tpc_register_sites(tpc::SiteWords *First, uint64_t Count);

/// It is about to be unloaded.
extern "C" __attribute__((visibility("default"))) void
tpc_forget_sites(tpc::SiteWords *First);

#endif // TPC_SITEWORDS_H
