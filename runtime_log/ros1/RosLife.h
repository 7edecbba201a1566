//===- RosLife.h - When roscpp may be touched -----------------------------===//
//
// This library may be called before ros::init, while roscpp starts, after
// ros::shutdown, while the process ends and in a forked child. roscpp's
// singletons are safe to use between its start and the end of the process, and
// never in a child of a process in which it was initialised.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_ROSLIFE_H
#define TPC_ROSLIFE_H

#include "ros1/RosControl.h"

#include <ros/callback_queue.h>

#include <functional>

namespace tpc {

/// While one of these is held (and true) the process does not get to the
/// destructors of roscpp's singletons, except after half a second of waiting.
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

/// Whether roscpp is started, its start is through, and it is not shutting
/// down. To be asked with a RosUse held.
bool rosIsUp();

/// Says, once in a process, that for this reason its reports are not on \p
/// Topic. Not at its end: such a process has to leave by _exit.
void warnOfFork(const char *Topic);

/// Runs what talks to the master, which may take for ever, in a thread of its
/// own with a RosUse held; one job at a time.
///
/// \returns whether the job was taken.
bool askMaster(std::function<void()> Job);

/// Nothing touches roscpp any more. Called again it does nothing.
void endRosUse();

/// A queue of roscpp's callbacks that wakes the helper thread.
class WakingQueue : public ros::CallbackQueue {
public:
  void addCallback(const ros::CallbackInterfacePtr &Callback,
                   uint64_t Owner = 0) override;
};

} // namespace tpc

#endif // TPC_ROSLIFE_H
