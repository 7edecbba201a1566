//===- SiteWords.h - What instrumented code and the library share ---------===//
//
// An instrumented module has one of these for each comparison, each in a cache
// line of its own, and passes the address of Key to log_one. While the policy
// is `light`, the module's code calls log_one only if Left[outcome] is 0. If it
// is positive, the code decrements it instead; if negative, it does nothing.
// A comparison that calls log_one_of does so only for the object Object: the
// words belong to one object at a time, and each evaluation of the others is a
// call.
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
  std::atomic<const void *> Object;
  char Key[56 - sizeof(void *)];
};
static_assert(sizeof(SiteWords) == 64 && offsetof(SiteWords, Object) == 8 &&
              offsetof(SiteWords, Key) == 8 + sizeof(void *));

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
