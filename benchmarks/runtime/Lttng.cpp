//===- Lttng.cpp - A report as an LTTng-UST tracepoint
//---------------------===//
//
// Which of the two it is says LTTNG_SITE.
//
//===----------------------------------------------------------------------===//
#define LTTNG_UST_TRACEPOINT_CREATE_PROBES
#define LTTNG_UST_TRACEPOINT_DEFINE
#include "LttngEvent.h"

#include "ByHand.h"

char Reporting = 1;

void log_one(char *key, bool result, double cmp, double thresh, bool res) {
#ifdef LTTNG_SITE
  (void)key;
  lttng_ust_tracepoint(tpc, report_site, 1, result, cmp, thresh, res);
#else
  lttng_ust_tracepoint(tpc, report, key, result, cmp, thresh, res);
#endif
}
