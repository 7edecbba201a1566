//===- Sink.h - Where reports go ------------------------------------------===//
#ifndef TPC_SINK_H
#define TPC_SINK_H

#include "Report.h"

namespace tpc {

/// Takes reports from any thread.
using Sink = void (*)(const Report &);

/// The thesis's: one ROS_INFO line a report, which appears on /rosout.
void logToRosout(const Report &R);

/// Nowhere.
inline void logNowhere(const Report &) {}

} // namespace tpc

#endif // TPC_SINK_H
