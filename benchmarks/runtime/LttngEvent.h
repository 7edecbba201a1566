//===- LttngEvent.h - The report as an LTTng-UST tracepoint
//----------------===//
//
// `report` has the key as text, `report_site` a number in its place. LTTng-UST
// includes this file several times and wants these macros.
//
//===----------------------------------------------------------------------===//
#undef LTTNG_UST_TRACEPOINT_PROVIDER
#define LTTNG_UST_TRACEPOINT_PROVIDER tpc

#undef LTTNG_UST_TRACEPOINT_INCLUDE
#define LTTNG_UST_TRACEPOINT_INCLUDE "LttngEvent.h"

#if !defined(TPC_BENCHMARKS_LTTNGEVENT_H) ||                                   \
    defined(LTTNG_UST_TRACEPOINT_HEADER_MULTI_READ)
#define TPC_BENCHMARKS_LTTNGEVENT_H

#include <lttng/tracepoint.h>
#include <stdint.h>

// clang-format off
LTTNG_UST_TRACEPOINT_EVENT(tpc, report,
  LTTNG_UST_TP_ARGS(const char *, key, uint8_t, result, double, cmp,
                    double, thresh, uint8_t, res),
  LTTNG_UST_TP_FIELDS(
    lttng_ust_field_string(key, key)
    lttng_ust_field_integer(uint8_t, result, result)
    lttng_ust_field_float(double, cmp, cmp)
    lttng_ust_field_float(double, thresh, thresh)
    lttng_ust_field_integer(uint8_t, res, res)))

LTTNG_UST_TRACEPOINT_EVENT(tpc, report_site,
  LTTNG_UST_TP_ARGS(uint32_t, site, uint8_t, result, double, cmp,
                    double, thresh, uint8_t, res),
  LTTNG_UST_TP_FIELDS(
    lttng_ust_field_integer(uint32_t, site, site)
    lttng_ust_field_integer(uint8_t, result, result)
    lttng_ust_field_float(double, cmp, cmp)
    lttng_ust_field_float(double, thresh, thresh)
    lttng_ust_field_integer(uint8_t, res, res)))
// clang-format on

#endif // TPC_BENCHMARKS_LTTNGEVENT_H

#include <lttng/tracepoint-event.h>
