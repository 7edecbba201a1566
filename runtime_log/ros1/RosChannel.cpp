//===- RosChannel.cpp - The topics that reports are sent on ---------------===//
//
// Batches are sent as std_msgs/String on /threshold_information or as
// rosgraph_msgs/Log on /rosout, and single reports as rosgraph_msgs/Log. What
// goes to /rosout goes through the publisher that roscpp has for it, not
// through roscpp's console: a thread that is inside the console when a signal
// handler shuts the node down may never come out.
//
// If a subscriber is too slow, roscpp queues messages and, when the queue is
// full, drops the oldest.
//
//===----------------------------------------------------------------------===//
#include "ros1/RosChannel.h"
#include "Clock.h"
#include "Runtime.h"
#include "ros1/RosControl.h"
#include "ros1/RosLife.h"

#include <ros/advertise_options.h>
#include <ros/init.h>
#include <ros/master.h>
#include <ros/names.h>
#include <ros/poll_manager.h>
#include <ros/publication.h>
#include <ros/this_node.h>
#include <ros/topic_manager.h>
#include <rosgraph_msgs/Log.h>
#include <std_msgs/String.h>
#include <xmlrpcpp/XmlRpcException.h>

#include <atomic>
#include <chrono>
#include <mutex>
#include <thread>

namespace tpc {
namespace {

/// Messages that wait for a slow subscriber: 100 seconds at five a second, and
/// at most 32 MiB.
constexpr uint32_t QueueMessages = 512;
/// How long roscpp's thread gets to write the last messages.
constexpr std::chrono::milliseconds LastMoment{50};
/// How long the first message waits for all subscribers that the master knows:
/// each takes a different time to connect, and all of them shall get
/// everything.
constexpr int64_t GatherNs = 1'000'000'000;
constexpr int64_t RetryNs = 2'000'000'000;

/// roscpp puts here what to do when a subscriber connects. Nothing has to be
/// done, but the sink looks for subscribers again.
class Doorbell : public ros::CallbackQueueInterface {
public:
  explicit Doorbell(std::atomic<bool> &Rung) : Rung(Rung) {}

  void addCallback(const ros::CallbackInterfacePtr &, uint64_t) override {
    Rung = true;
    wakeHelper();
  }
  void removeByID(uint64_t) override {}

private:
  std::atomic<bool> &Rung;
};

class RosChannel final : public Channel {
public:
  enum class Form : uint8_t {
    Strings, ///< batches on /threshold_information
    Logs,    ///< batches on /rosout
    OneByOne ///< a message on /rosout for each report
  };

  explicit RosChannel(Form F)
      : F(F), Topic(F == Form::Strings ? "/threshold_information" : "/rosout") {
  }

  const char *topic() const override { return Topic; }
  const char *prefix() const override {
    return F == Form::Logs ? "threshold_batch:" : "";
  }
  bool isAdvertised() const override { return Advertised; }
  bool hasToLook() const override { return Rung; }
  void poll(Outbox &From) override;
  void end(Outbox &From) override;

private:
  void advertise();
  bool sendWaiting(Outbox &From, bool AtOnce);

  const Form F;
  const char *const Topic;

  std::mutex
      SendLock; ///< for the next three; never held while the master is asked
  boost::weak_ptr<ros::Publication> Publication;
  uint32_t Expected = 0; ///< subscribers, until GatherUntil
  int64_t GatherUntil = 0;

  std::atomic<int64_t> RetryAt{0};
  std::atomic<bool> Advertised{false}; ///< or never will be
  std::atomic<bool> Rung{false};       ///< somebody has subscribed
  Doorbell Bell{Rung};
};

/// The number of subscribers of a topic that the master knows.
uint32_t subscribersOf(const std::string &Topic) {
  XmlRpc::XmlRpcValue Arguments, Result, State;
  Arguments[0] = ros::this_node::getName();
  if (!ros::master::execute("getSystemState", Arguments, Result, State, false))
    return 0;
  try {
    XmlRpc::XmlRpcValue &Subscribed = State[1];
    for (int I = 0; I < Subscribed.size(); ++I)
      if (static_cast<std::string &>(Subscribed[I][0]) == Topic)
        return static_cast<uint32_t>(Subscribed[I][1].size());
  } catch (const XmlRpc::XmlRpcException &) {
    // The master returned its graph in another form.
  }
  return 0;
}

/// Advertises the topic; tries again later if the master does not answer.
void RosChannel::advertise() {
  if (!ros::master::check()) {
    RetryAt = Clock::steady() + RetryNs;
    return;
  }
  ros::AdvertiseOptions Options;
  const std::string Name = ros::names::resolve(Topic);
  if (F != Form::Strings)
    Options.init<rosgraph_msgs::Log>(Name, QueueMessages);
  else
    Options.init<std_msgs::String>(Name, QueueMessages);
  const auto Callbacks = boost::make_shared<ros::SubscriberCallbacks>(
      [](const ros::SingleSubscriberPublisher &) {},
      ros::SubscriberStatusCallback(), ros::VoidConstPtr(), &Bell);
  const ros::TopicManagerPtr &Topics = ros::TopicManager::instance();
  // If roscpp publishes on the topic, its publisher gets one more user.
  if (Topics->advertise(Options, Callbacks)) {
    const uint32_t Known = subscribersOf(Options.topic);
    std::lock_guard<std::mutex> Guard(SendLock);
    Publication = Topics->lookupPublication(Options.topic);
    Expected = Known;
    GatherUntil = Clock::steady() + GatherNs;
  } else if (!ros::isShuttingDown()) {
    warn("nothing is sent on " + Options.topic +
         ": this process uses the topic with another type");
  }
  Advertised = true;
}

ros::SerializedMessage logOf(int64_t Stamp, std::string Text) {
  rosgraph_msgs::Log Message;
  Message.header.stamp.fromNSec(static_cast<uint64_t>(Stamp));
  Message.level = rosgraph_msgs::Log::INFO;
  Message.name = ros::this_node::getName();
  Message.msg = std::move(Text);
  return ros::serialization::serializeMessage(Message);
}

ros::SerializedMessage stringOf(std::string Text) {
  std_msgs::String Message;
  Message.data = std::move(Text);
  return ros::serialization::serializeMessage(Message);
}

/// Sends what is waiting if somebody listens: everything with \p AtOnce;
/// otherwise what has waited for the time of a batch or fills a message.
///
/// \returns whether something was sent.
bool RosChannel::sendWaiting(Outbox &From, bool AtOnce) {
  std::lock_guard<std::mutex> Sending(SendLock);
  const auto To = Publication.lock();
  // In this order, so that one of the two sees a subscriber that connects in
  // between.
  Rung = false;
  if (!To || To->isDropped() || !To->hasSubscribers()) {
    From.setSubscribers(0);
    return false;
  }
  From.setSubscribers(To->getNumSubscribers());
  if (!AtOnce && To->getNumSubscribers() < Expected &&
      Clock::steady() < GatherUntil)
    return false;
  const auto Send = [&](int64_t Stamp, std::string Text, const char *) {
    // Not TopicManager::publish, which looks up the topic again and crashes
    // if the topic was removed in that moment.
    ros::SerializedMessage Bytes = F == Form::Strings
                                       ? stringOf(std::move(Text))
                                       : logOf(Stamp, std::move(Text));
    To->publish(Bytes);
  };
  const bool HasSent = From.send(AtOnce, Send);
  if (HasSent)
    ros::PollManager::instance()->getPollSet().signal();
  return HasSent;
}

void RosChannel::poll(Outbox &From) {
  RosUse Use;
  if (!Use)
    return;
  if (!Advertised) {
    if (rosIsUp() && Clock::steady() >= RetryAt)
      askMaster([this] {
        if (!Advertised)
          advertise();
      });
    return;
  }
  // While the node shuts down, its threads still work for a moment.
  sendWaiting(From, !rosIsUp());
}

void RosChannel::end(Outbox &From) {
  RosUse Use;
  if (Use && sendWaiting(From, true))
    std::this_thread::sleep_for(LastMoment);
}

} // namespace

Channel &rosChannel(SinkKind K) {
  // Never destroyed: threads may report until the very end.
  static auto &Strings = *new RosChannel(RosChannel::Form::Strings);
  static auto &Logs = *new RosChannel(RosChannel::Form::Logs);
  static auto &OneByOne = *new RosChannel(RosChannel::Form::OneByOne);
  return K == SinkKind::Topic ? Strings : K == SinkKind::Auto ? Logs : OneByOne;
}

} // namespace tpc
