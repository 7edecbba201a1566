//===- TopicSink.cpp ------------------------------------------------------===//
//
// Three sinks: one sends batches as std_msgs/String on /threshold_information,
// one batches as rosgraph_msgs/Log on /rosout, and one a rosgraph_msgs/Log for
// each report, as the thesis has it. What goes to /rosout goes through the
// publisher that roscpp has for it, not through roscpp's console: a thread that
// is inside the console when a signal handler shuts the node down may never
// come out.
//
// Reports wait as bytes in a store of blocks until the helper thread makes
// messages of them. If a subscriber is too slow, roscpp queues messages and,
// when the queue is full, drops the oldest. A reader notices this because each
// message has the number of its first report.
//
//===----------------------------------------------------------------------===//
#include "Clock.h"
#include "Runtime.h"
#include "Sink.h"
#include "TopicStore.h"
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
#include <pthread.h>
#include <thread>
#include <unistd.h>

namespace tpc {
namespace {

constexpr const char *Reports = "/threshold_information";
constexpr const char *Rosout = "/rosout";
/// Stands before the batch in a log message.
constexpr const char *BatchPrefix = "threshold_batch:";
constexpr size_t MessageBytes = size_t(64) * 1024;
/// Messages that wait for a slow subscriber: 100 seconds at five a second, and
/// at most 32 MiB.
constexpr uint32_t QueueMessages = 512;
/// The time between two messages: five a second for each node, with some
/// allowance for the time between two polls. If every poll sent a message, a
/// node that reports 50 times a second would send one for each report.
constexpr int64_t BatchNs = 190'000'000;
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

class TopicSink : public Sink {
public:
  enum class Form : uint8_t {
    Strings, ///< batches on /threshold_information
    Logs,    ///< batches on /rosout
    OneByOne ///< a message on /rosout for each report
  };

  explicit TopicSink(Form F)
      : F(F), Topic(F == Form::Strings ? Reports : Rosout) {}

  void take(const Report &R) override;
  void take(const Summary &S) override;
  void take(const Dropped &D) override;
  void take(const ReadName &N) override;
  void poll() override;
  bool isPolled() const override;
  void end() override;
  std::string status() const override;

  // Called around fork(), which may happen while another thread holds the lock.
  void beforeFork() { StoreLock.lock(); }
  void afterFork(bool InChild);

private:
  template <typename F> void keep(F Add);
  void advertise();
  bool sendWaiting(bool AtOnce);
  void send(ros::Publication &To, const TopicStore::Batch &Batch);
  void sendOneByOne(ros::Publication &To, const TopicStore::Batch &Batch);

  const Form F;
  const char *const Topic;
  std::mutex StoreLock; ///< for the next two
  TopicStore Store;
  int64_t OldestAt = 0; ///< since when something is waiting

  std::mutex
      SendLock; ///< for the next three; never held while the master is asked
  boost::weak_ptr<ros::Publication> Publication;
  uint32_t Expected = 0; ///< subscribers, until GatherUntil
  int64_t GatherUntil = 0;

  std::atomic<uint64_t> Sent{0};
  std::atomic<int64_t> RetryAt{0};
  std::atomic<bool> Advertised{false}; ///< or never will be
  std::atomic<bool> Subscribed{false};
  std::atomic<bool> Something{false}; ///< waits
  Doorbell Bell{Subscribed};
};

/// Never destroyed: threads may report until the very end.
struct Sinks {
  TopicSink OfForm[3]{TopicSink{TopicSink::Form::Strings},
                      TopicSink{TopicSink::Form::Logs},
                      TopicSink{TopicSink::Form::OneByOne}};

  Sinks() {
    pthread_atfork(
        [] {
          for (TopicSink &S : all().OfForm)
            S.beforeFork();
        },
        [] { all().afterFork(false); }, [] { all().afterFork(true); });
  }

  void afterFork(bool InChild) {
    for (TopicSink &S : OfForm)
      S.afterFork(InChild);
  }

  static TopicSink &of(TopicSink::Form F) {
    return all().OfForm[static_cast<size_t>(F)];
  }

  static Sinks &all() {
    static Sinks &Only = *new Sinks;
    return Only;
  }
};

void TopicSink::afterFork(bool InChild) {
  if (InChild) {
    // What is waiting belongs to the parent.
    Store = TopicStore();
    Something = false;
  }
  StoreLock.unlock();
}

template <typename F> void TopicSink::keep(F Add) {
  bool Wake;
  {
    std::lock_guard<std::mutex> Guard(StoreLock);
    const size_t Before = Store.bytes();
    if (!Something)
      OldestAt = Clock::steady();
    Wake = !Something.exchange(true);
    Add();
    Wake |= Before < MessageBytes && Store.bytes() >= MessageBytes;
  }
  if (Wake && Subscribed)
    wakeHelper();
}

void TopicSink::take(const Report &R) {
  if (forkedFromNode())
    return warnOfFork(Topic);
  TopicStore::Time When{rosNow(), false};
  if (When.Ns == 0 && !rosTimeIsSimulated()) {
    When = {Clock::real(), true};
  }
  keep([&] { Store.add(When, R); });
}

void TopicSink::take(const Summary &S) {
  if (forkedFromNode())
    return warnOfFork(Topic);
  keep([&] { Store.add({S.EndRos, false}, S, F != Form::OneByOne); });
}

void TopicSink::take(const Dropped &D) {
  if (!forkedFromNode())
    keep([&] { Store.add(D); });
}

void TopicSink::take(const ReadName &N) {
  if (!forkedFromNode())
    keep([&] { Store.add(N); });
}

bool TopicSink::isPolled() const {
  return !Advertised || (Subscribed && Something);
}

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
void TopicSink::advertise() {
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

/// Sends what is waiting if somebody listens: everything with \p AtOnce;
/// otherwise what has waited for the time of a batch or fills a message.
///
/// \returns whether something was sent.
bool TopicSink::sendWaiting(bool AtOnce) {
  std::lock_guard<std::mutex> Sending(SendLock);
  const auto To = Publication.lock();
  // In this order, so that one of the two sees a subscriber that connects in
  // between.
  Subscribed = false;
  if (!To || To->isDropped() || !To->hasSubscribers())
    return false;
  Subscribed = true;
  if (!AtOnce && To->getNumSubscribers() < Expected &&
      Clock::steady() < GatherUntil)
    return false;
  TopicStore::Batch Batch;
  {
    std::lock_guard<std::mutex> Guard(StoreLock);
    const bool MayWait = !AtOnce && F != Form::OneByOne;
    if (!Something || (MayWait && Store.bytes() < MessageBytes &&
                       Clock::steady() - OldestAt < BatchNs))
      return false;
    Batch = Store.takeAll();
    Something = false;
  }
  if (F == Form::OneByOne)
    sendOneByOne(*To, Batch);
  else
    send(*To, Batch);
  ros::PollManager::instance()->getPollSet().signal();
  return true;
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

void TopicSink::send(ros::Publication &To, const TopicStore::Batch &Batch) {
  const std::string Process = ",pid:" + std::to_string(getpid());
  const std::string Dropped = ",dropped:" + std::to_string(Batch.DroppedInAll);
  for (const TopicStore::Lines &Part :
       linesOf(Batch, rosNow(), rosTimeIsSimulated(), MessageBytes)) {
    std::string Text = "#seq:" + std::to_string(Sent) +
                       ",count:" + std::to_string(Part.Reports) + Dropped +
                       Process + ",steady:" + seconds(Clock::steady(), 9) +
                       Part.Text;
    Sent += Part.Reports;
    // Not TopicManager::publish, which looks up the topic again and crashes if
    // the topic was removed in that moment.
    ros::SerializedMessage Bytes = F == Form::Strings
                                       ? stringOf(std::move(Text))
                                       : logOf(rosNow(), BatchPrefix + Text);
    To.publish(Bytes);
  }
}

void TopicSink::sendOneByOne(ros::Publication &To,
                             const TopicStore::Batch &Batch) {
  forEachLine(Batch, rosNow(), rosTimeIsSimulated(),
              [&](LineKind Kind, int64_t Ns, std::string_view Text) {
                Sent += Kind == LineKind::Report;
                ros::SerializedMessage Bytes =
                    logOf(Ns, std::string(prefixOf(Kind)).append(Text));
                To.publish(Bytes);
              });
}

void TopicSink::poll() {
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
  sendWaiting(!rosIsUp());
}

void TopicSink::end() {
  {
    RosUse Use;
    if (Use && sendWaiting(true))
      std::this_thread::sleep_for(LastMoment);
  }
  if (forkedFromNode())
    return;
  uint64_t Unsent;
  {
    std::lock_guard<std::mutex> Guard(StoreLock);
    Unsent = Store.giveUp();
    Something = false;
  }
  // In batches on /rosout it is the last second of each node, and everything in
  // a program without ROS: nobody has asked for these.
  if (Unsent && F != Form::Logs)
    warn(std::to_string(Unsent) + " evaluations were not sent on " + Topic +
         ": nobody listened, or the node was shut down");
}

std::string TopicSink::status() const {
  return "sent=" + std::to_string(Sent) +
         (Something ? " waiting=yes" : " waiting=no") +
         (Subscribed ? " subscribed=yes" : " subscribed=no");
}

} // namespace

Sink &topicSink() { return Sinks::of(TopicSink::Form::Strings); }
Sink &autoSink() { return Sinks::of(TopicSink::Form::Logs); }
Sink &rosoutSink() { return Sinks::of(TopicSink::Form::OneByOne); }

} // namespace tpc
