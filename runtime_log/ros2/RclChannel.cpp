//===- RclChannel.cpp -----------------------------------------------------===//
//
// Batches are sent as std_msgs/msg/String on /threshold_information, and single
// reports as rcl_interfaces/msg/Log on /rosout through a publisher of this
// library's own: rcl's logging would print each line.
//
//===----------------------------------------------------------------------===//
#include "ros2/RclChannel.h"
#include "Clock.h"
#include "HostCalls.h"
#include "RclState.h"
#include "Runtime.h"
#include "ros2/Rcl.h"
#include "ros2/RclGraph.h"

#include <rcl/event.h>
#include <rcl/graph.h>
#include <rcl/publisher.h>
#include <rcl_interfaces/msg/log.h>
#include <rmw/qos_profiles.h>
#include <rosidl_runtime_c/string_functions.h>
#include <std_msgs/msg/string.h>

#include <algorithm>
#include <atomic>

namespace tpc {
namespace {

constexpr int64_t Ms = 1'000'000;
constexpr int64_t Second = 1'000 * Ms;
/// Messages that wait for a slow subscriber: 100 seconds at five a second, and
/// at most 32 MiB.
constexpr size_t KeptMessages = 512;
/// How long the first message waits for further subscribers, and for those that
/// the node knows of: each takes a different time to connect, and all of them
/// shall get everything.
constexpr int64_t SettleNs = 300 * Ms, GatherNs = Second;
constexpr size_t KeptLogs = 1000;
/// After so many single messages, of those that are kept, a subscriber gets
/// a moment to acknowledge them; one that does not is not waited for again at
/// once.
constexpr uint32_t UnseenMessages = 500;
constexpr int64_t SeenNs = 100 * Ms;
/// How long the subscribers get to acknowledge the last messages: what was not
/// sent again by then is lost, and Fast DDS asks every three seconds what is
/// missing. ROS itself gives a process five seconds to end.
constexpr int64_t LastNs = 4 * Second;

class RclChannel final : public Channel {
public:
  explicit RclChannel(bool IsLog) : IsLog(IsLog) {}

  const char *topic() const override {
    return IsLog ? "/rosout" : "/threshold_information";
  }
  std::string head() const override {
    return std::string(",node:") + RclGraph::of().name();
  }
  bool isAdvertised() const override { return Advertised; }
  bool hasToLook() const override { return Rung || !HasBell; }
  void poll(Outbox &From) override;
  void end(Outbox &From) override;
  void finish();

private:
  void advertise();
  bool ring();
  bool hasGathered(size_t Matched);
  bool sendWaiting(Outbox &From, bool AtOnce);
  void send(int64_t Stamp, const std::string &Text, const char *Node);

  const bool IsLog;
  rcl_publisher_t Publisher = rcl_get_zero_initialized_publisher();
  rcl_event_t Matching = rcl_get_zero_initialized_event();
  bool IsMade = false; ///< Publisher
  bool HasGathered = false;
  int64_t MatchedAt = 0; ///< the first subscriber; 0: none
  uint32_t SeenShutdowns = 0;
  uint32_t Unseen = 0;                 ///< messages since all were acknowledged
  bool IsSeen = true;                  ///< in time, since poll() was called
  std::atomic<bool> Advertised{false}; ///< or never will be
  std::atomic<bool> HasBell{false};    ///< Rung is set for a new subscriber
  std::atomic<bool> Rung{false};
};

void RclChannel::advertise() {
  rcl_publisher_options_t Options = rcl_publisher_get_default_options();
  // Reliable, volatile, keep last.
  Options.qos.depth = KeptMessages;
  if (IsLog) {
    // As every node publishes there.
    Options.qos.depth = KeptLogs;
    Options.qos.durability = RMW_QOS_POLICY_DURABILITY_TRANSIENT_LOCAL;
    Options.qos.lifespan = {10, 0};
  }
  const rosidl_message_type_support_t *Type =
      IsLog ? ROSIDL_GET_MSG_TYPE_SUPPORT(rcl_interfaces, msg, Log)
            : ROSIDL_GET_MSG_TYPE_SUPPORT(std_msgs, msg, String);
  IsMade = rcl_publisher_init(&Publisher, &RclGraph::of().node(), Type, topic(),
                              &Options) == RCL_RET_OK;
  if (IsMade)
    HasBell = ring();
  else
    warn(std::string("nothing is sent on ") + topic() + ": " + reasonOfRcl());
  Rung = true;
  Advertised = true;
}

/// Lets the middleware set Rung for a new subscriber. If it cannot, returns
/// false, and is asked again and again.
bool RclChannel::ring() {
#if TPC_RCL_VERSION >= 6
  return isOk(rcl_publisher_event_init(&Matching, &Publisher,
                                       RCL_PUBLISHER_MATCHED)) &&
         isOk(rcl_event_set_callback(
             &Matching,
             [](const void *This, size_t) {
               const_cast<RclChannel *>(static_cast<const RclChannel *>(This))
                   ->Rung = true;
               wakeHelper();
             },
             this));
#else
  return false;
#endif
}

/// Whether the first message may be sent to \p Matched subscribers.
bool RclChannel::hasGathered(size_t Matched) {
  const int64_t Now = Clock::steady();
  if (!MatchedAt)
    MatchedAt = Now;
  size_t Known = 0;
  isOk(rcl_count_subscribers(&RclGraph::of().node(), topic(), &Known));
  const int64_t Waited = Now - MatchedAt;
  return Waited >= GatherNs || (Waited >= SettleNs && Matched >= Known);
}

/// Sends what is waiting if somebody listens: everything with \p AtOnce;
/// otherwise what has waited for the time of a batch or fills a message.
///
/// \returns whether something was sent.
bool RclChannel::sendWaiting(Outbox &From, bool AtOnce) {
  // In this order, so that one of the two sees a subscriber that comes in
  // between.
  Rung = false;
  size_t Matched = 0;
  if (!IsMade ||
      !isOk(rcl_publisher_get_subscription_count(&Publisher, &Matched)))
    Matched = 0;
  From.setSubscribers(Matched);
  if (!Matched) {
    HasGathered = false;
    MatchedAt = 0;
    return false;
  }
  if (!HasGathered)
    HasGathered = AtOnce || hasGathered(Matched);
  IsSeen = true;
  return HasGathered &&
         From.send(AtOnce, [this](int64_t Stamp, const std::string &Text,
                                  const char *Node) {
           send(Stamp, Text, Node ? Node : RclGraph::of().name());
         });
}

void RclChannel::send(int64_t Stamp, const std::string &Text,
                      const char *Node) {
  if (!IsLog) {
    std_msgs__msg__String Message;
    if (std_msgs__msg__String__init(&Message) &&
        rosidl_runtime_c__String__assignn(&Message.data, Text.data(),
                                          Text.size()))
      isOk(rcl_publish(&Publisher, &Message, nullptr));
    std_msgs__msg__String__fini(&Message);
    return;
  }
  // The logger of /robot1/guard is robot1.guard.
  std::string Logger = Node + 1;
  std::replace(Logger.begin(), Logger.end(), '/', '.');
  rcl_interfaces__msg__Log Message;
  if (rcl_interfaces__msg__Log__init(&Message) &&
      rosidl_runtime_c__String__assign(&Message.name, Logger.c_str()) &&
      rosidl_runtime_c__String__assignn(&Message.msg, Text.data(),
                                        Text.size())) {
    Message.level = rcl_interfaces__msg__Log__INFO;
    Message.stamp.sec = static_cast<int32_t>(Stamp / Second);
    Message.stamp.nanosec = static_cast<uint32_t>(Stamp % Second);
    isOk(rcl_publish(&Publisher, &Message, nullptr));
  }
  rcl_interfaces__msg__Log__fini(&Message);
  if (++Unseen < UnseenMessages)
    return;
  Unseen = 0;
  if (IsSeen)
    IsSeen = isOk(rcl_publisher_wait_for_all_acked(&Publisher, SeenNs));
}

void RclChannel::poll(Outbox &From) {
  const RclGraph &Graph = RclGraph::of();
  if (!Graph.isUp() || Graph.isForked())
    return;
  if (!Advertised)
    advertise();
  // A program that was shut down may end at any moment.
  const uint32_t Shutdowns = host().rcl().Shutdowns;
  sendWaiting(From, SeenShutdowns != Shutdowns);
  SeenShutdowns = Shutdowns;
}

void RclChannel::end(Outbox &From) {
  const RclGraph &Graph = RclGraph::of();
  if (!Advertised || !IsMade || !Graph.isUp() || Graph.isForked())
    return;
  sendWaiting(From, true);
  // Also for what poll() has sent a moment ago.
  isOk(rcl_publisher_wait_for_all_acked(&Publisher, LastNs));
}

void RclChannel::finish() {
  if (HasBell.exchange(false))
    isOk(rcl_event_fini(&Matching));
  if (IsMade)
    isOk(rcl_publisher_fini(&Publisher, &RclGraph::of().node()));
  IsMade = false;
}

/// Never destroyed: threads may report until the very end.
struct Channels {
  RclChannel Batches{false}, Logs{true};

  static Channels &all() {
    static auto &Only = *new Channels;
    return Only;
  }
};

} // namespace

Channel &rclChannel(SinkKind K) {
  Channels &All = Channels::all();
  return K == SinkKind::Rosout ? All.Logs : All.Batches;
}

void endRclChannels() {
  Channels::all().Batches.finish();
  Channels::all().Logs.finish();
}

} // namespace tpc
