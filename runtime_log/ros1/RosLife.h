//===- RosLife.h - When roscpp may be used --------------------------------===//
//
// This library may be called before ros::init, while roscpp starts, after
// ros::shutdown, while the process ends and in a forked child. The singletons
// of roscpp are safe to use between its start and the end of the process, and
// never in a child of a process that had initialised roscpp.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_ROSLIFE_H
#define TPC_ROSLIFE_H

#include "ros1/RosControl.h"

#include <ros/callback_queue.h>

#include <functional>

namespace tpc {

/// While one of these exists (and is true), the process does not destroy the
/// singletons of roscpp, or does so only after waiting for half a second.
class RosUse {
public:
  RosUse();
  ~RosUse();
  RosUse(const RosUse &) = delete;
  RosUse &operator=(const RosUse &) = delete;
  explicit operator bool() const { return Held; }

private:
  bool Held;
};

/// Whether roscpp has started completely and is not shutting down. Call it
/// while holding a RosUse.
bool rosIsUp();

/// Runs a job that talks to the master, which may take for ever, in a thread of
/// its own that holds a RosUse; one job at a time.
///
/// \returns whether the job was accepted.
bool askMaster(std::function<void()> Job);

/// No code may use roscpp after this call. A second call does nothing.
void endRosUse();

/// A queue of roscpp callbacks that wakes the helper thread.
class WakingQueue : public ros::CallbackQueue {
public:
  void addCallback(const ros::CallbackInterfacePtr &Callback,
                   uint64_t Owner = 0) override;
};

} // namespace tpc

#endif // TPC_ROSLIFE_H
