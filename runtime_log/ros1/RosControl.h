//===- RosControl.h - Settings by ROS parameters and a service ------------===//
#ifndef TPC_ROSCONTROL_H
#define TPC_ROSCONTROL_H

#include <cstdint>

namespace tpc {

/// Called by the helper thread. Once roscpp has started, applies the parameters
/// and advertises `~tpc/reload`; answers requests.
///
/// \returns after how many nanoseconds to call it again; -1: only after
/// wakeHelper() was called. Never throws.
int64_t pollRos();

/// The process ends: withdraws the service.
void rosEnd();

/// Whether this process was forked from one that had initialised roscpp: the
/// threads of roscpp are missing here, and its locks may stay locked.
bool forkedFromNode();

/// The name of this process's node; empty if it is not known (yet).
const char *rosNodeName();

/// Whether roscpp's time is simulated.
bool rosTimeIsSimulated();

/// roscpp's time in nanoseconds; 0 if it is not known yet.
int64_t rosNow();

} // namespace tpc

#endif // TPC_ROSCONTROL_H
