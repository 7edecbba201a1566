//===- RosControl.h - Settings by ROS parameters and a service ------------===//
#ifndef TPC_ROSCONTROL_H
#define TPC_ROSCONTROL_H

#include <cstdint>

namespace tpc {

/// Looks after ROS, in the helper thread: once roscpp is started, takes over
/// the parameters and advertises `~tpc/reload`; answers what was asked of it.
///
/// \returns after how many nanoseconds it is to be called again, or -1: only
/// when wakeHelper() was called. Never throws.
int64_t rosTurn();

/// The process ends: withdraws the service.
void rosEnd();

/// Whether this process was forked from one in which roscpp was initialised:
/// its threads are not here, and their locks may never be opened.
bool forkedFromNode();

/// The name of this process's node, empty where it is not known (yet).
const char *rosNodeName();

/// Whether roscpp's time is simulated.
bool rosTimeIsSimulated();

/// roscpp's time in nanoseconds, 0 where it is not known yet.
int64_t rosNow();

} // namespace tpc

#endif // TPC_ROSCONTROL_H
