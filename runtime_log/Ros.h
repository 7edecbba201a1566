//===- Ros.h - The ROS of this process ------------------------------------===//
//
// Answers for a process without ROS, too.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_ROS_H
#define TPC_ROS_H

#include "Backend.h"

#include <cstdint>
#include <string>

namespace tpc {

/// The backend of the ROS that this process has loaded; null if it has none, or
/// the backend cannot be loaded.
Backend *rosBackend();

/// Called by the helper thread without a lock: loads the backend if the process
/// has loaded ROS by now, and calls its poll().
///
/// \returns after how many nanoseconds to call it again; -1: only after
/// wakeHelper() was called. Never throws.
int64_t pollRos();

/// Why the reports of this process cannot reach the ROS that it has loaded;
/// empty if they can, or if there is no ROS.
std::string whyNoRos();

/// The process ends; see Backend::end.
void rosEnd(bool IsInterrupted);

bool forkedFromNode();

/// The name of this process's node; empty if it is not known (yet).
const char *rosNodeName();

/// Whether ROS time is simulated.
bool rosTimeIsSimulated();

/// ROS time in nanoseconds; 0 if it is not known yet.
int64_t rosNow();

} // namespace tpc

#endif // TPC_ROS_H
