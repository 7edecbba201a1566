//===- TopicSink.cpp - Reports that wait for a topic ----------------------===//
//
// Three sinks: auto and topic send batches, and rosout sends a message for each
// report, as the thesis has it. Where to is decided by the ROS of the process
// (Backend.h). Reports wait as bytes in a store of blocks until the helper
// thread makes messages of them. A reader notices what ROS has dropped because
// each message has the number of its first report.
//
//===----------------------------------------------------------------------===//
#include "Clock.h"
#include "LogFile.h"
#include "Modes.h"
#include "ReadNames.h"
#include "Ros.h"
#include "Runtime.h"
#include "Sink.h"
#include "TopicStore.h"

#include <atomic>
#include <mutex>
#include <unistd.h>

namespace tpc {
namespace {

constexpr size_t MessageBytes = size_t(64) * 1024;
/// The time between two messages: five a second for each node, with some
/// allowance for the time between two polls. If every poll sent a message, a
/// node that reports 50 times a second would send one for each report.
constexpr int64_t BatchNs = 190'000'000;

class TopicSink final : public Sink, public Outbox {
public:
  explicit TopicSink(SinkKind K) : K(K) {}

  void take(const Report &R) override;
  void take(const Summary &S) override;
  void take(const Dropped &D) override;
  void take(const ReadName &N) override;
  void poll() override;
  bool isPolled() const override;
  void end() override;
  void giveTo(LogFile &To) override;
  std::string status() const override;

  void setSubscribers(size_t Count) override;
  bool send(bool AtOnce, const Take &Send) override;

  // Called around fork(), which may happen while another thread holds the lock.
  void beforeFork() { StoreLock.lock(); }
  void afterFork(bool InChild);

private:
  template <typename F> void keep(F Add);
  const char *topic() const;
  void warnOfFork() const;
  void sendBatches(const TopicStore::Batch &Batch, const Take &Send);
  void sendOneByOne(const TopicStore::Batch &Batch, const Take &Send);

  Channel *channel() const {
    Backend *B = rosBackend();
    return B ? &B->channel(K) : nullptr;
  }
  /// As far as is known.
  bool isListenedTo(const Channel *C) const {
    return Subscribed || (C && C->hasToLook());
  }
  bool isOneByOne() const { return K == SinkKind::Rosout; }

  const SinkKind K;
  std::mutex StoreLock; ///< for the next two
  TopicStore Store;
  int64_t OldestAt = 0; ///< since when something is waiting

  std::atomic<size_t> Subscribed{0};  ///< how many listen
  std::atomic<bool> Something{false}; ///< waits
};

/// Never destroyed: threads may report until the very end.
struct Sinks {
  TopicSink Topic{SinkKind::Topic}, Auto{SinkKind::Auto},
      Rosout{SinkKind::Rosout};

  template <typename Function, typename... Values>
  void each(Function Call, Values... V) {
    for (TopicSink *S : {&Topic, &Auto, &Rosout})
      (S->*Call)(V...);
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

const char *TopicSink::topic() const {
  if (const Channel *C = channel())
    return C->topic();
  return K == SinkKind::Topic ? "/threshold_information" : "/rosout";
}

/// Once per process. Not at its end, because such a process has to leave by
/// _exit.
void TopicSink::warnOfFork() const {
  static std::atomic<bool> Said{false};
  if (!Said.exchange(true))
    warn("process " + std::to_string(getpid()) +
         " was forked from a node: its reports do not reach " + topic() +
         "; the sink file records them");
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
  if (Wake && isListenedTo(channel()))
    wakeHelper();
}

void TopicSink::take(const Report &R) {
  if (forkedFromNode())
    return warnOfFork();
  TopicStore::Time When{rosNow(), false};
  if (When.Ns == 0 && !rosTimeIsSimulated()) {
    When = {Clock::real(), true};
  }
  keep([&] { Store.add(When, R); });
}

void TopicSink::take(const Summary &S) {
  if (forkedFromNode())
    return warnOfFork();
  keep([&] { Store.add({S.EndRos, false}, S, !isOneByOne()); });
}

void TopicSink::take(const Dropped &D) {
  if (!forkedFromNode())
    keep([&] { Store.add(D); });
}

void TopicSink::take(const ReadName &N) {
  if (!forkedFromNode())
    keep([&] { Store.add(N); });
}

void TopicSink::setSubscribers(size_t Count) {
  if (Subscribed.exchange(Count) >= Count)
    return;
  // The first reports that a new one gets come with their names.
  ReadNames &Names = ReadNames::all();
  Names.startAgain();
  Names.give(*this, Clock::steady());
}

bool TopicSink::isPolled() const {
  Channel *C = channel();
  return C && (!C->isAdvertised() || (Something && isListenedTo(C)));
}

void TopicSink::poll() {
  if (Channel *C = channel())
    C->poll(*this);
}

bool TopicSink::send(bool AtOnce, const Take &Send) {
  TopicStore::Batch Batch;
  {
    std::lock_guard<std::mutex> Guard(StoreLock);
    const bool MayWait = !AtOnce && !isOneByOne();
    if (!Something || (MayWait && Store.bytes() < MessageBytes &&
                       Clock::steady() - OldestAt < BatchNs))
      return false;
    Batch = Store.takeAll();
    Something = false;
  }
  if (isOneByOne())
    sendOneByOne(Batch, Send);
  else
    sendBatches(Batch, Send);
  return true;
}

void TopicSink::sendBatches(const TopicStore::Batch &Batch, const Take &Send) {
  Channel &To = *channel();
  const std::string Dropped = ",dropped:" + std::to_string(Batch.DroppedInAll) +
                              ",pid:" + std::to_string(getpid());
  for (const TopicStore::Lines &Part :
       linesOf(Batch, rosNow(), rosTimeIsSimulated(), MessageBytes)) {
    std::string Text = To.prefix();
    ((Text += "#seq:") += std::to_string(To.Sent)) += ",count:";
    (Text += std::to_string(Part.Reports)) += Dropped;
    ((Text += ",steady:") += seconds(Clock::steady(), 9)) += To.head();
    Text += Part.Text;
    To.Sent += Part.Reports;
    Send(rosNow(), std::move(Text), nullptr);
  }
}

void TopicSink::sendOneByOne(const TopicStore::Batch &Batch, const Take &Send) {
  Channel &To = *channel();
  forEachLine(
      Batch, rosNow(), rosTimeIsSimulated(),
      [&](LineKind Kind, int64_t Ns, std::string_view Text, const char *Node) {
        To.Sent += Kind == LineKind::Report;
        Send(Ns, std::string(prefixOf(Kind)).append(Text), Node);
      });
}

void TopicSink::end() {
  if (Channel *C = channel())
    C->end(*this);
  if (forkedFromNode())
    return;
  uint64_t Unsent;
  {
    std::lock_guard<std::mutex> Guard(StoreLock);
    Unsent = Store.giveUp();
    Something = false;
  }
  // With auto it is the last second of each node, and everything in a program
  // without ROS: nobody has asked for these.
  if (Unsent && (K != SinkKind::Auto || !whyNoRos().empty()))
    warn(std::to_string(Unsent) + " evaluations were not sent on " + topic() +
         ": nobody listened, or the node was shut down");
}

void TopicSink::giveTo(LogFile &To) {
  Thread *T = Something ? ThisThread ? ThisThread : makeThread() : nullptr;
  if (!T)
    return;
  ReportMark Mark(*T);
  // Within a report, everything waits for the next call.
  if (!Mark)
    return;
  TopicStore::Batch Batch;
  {
    std::lock_guard<std::mutex> Guard(StoreLock);
    Batch = Store.takeAll();
    Something = false;
  }
  write(Batch, edgeBit(), rosTimeIsSimulated(), *T, To);
}

std::string TopicSink::status() const {
  Channel *C = channel();
  return "sent=" + std::to_string(C ? C->Sent.load() : 0) +
         (Something ? " waiting=yes" : " waiting=no") +
         (Subscribed ? " subscribed=yes" : " subscribed=no");
}

} // namespace

Sink &topicSink() { return Sinks::all().Topic; }
Sink &autoSink() { return Sinks::all().Auto; }
Sink &rosoutSink() { return Sinks::all().Rosout; }

void lockStores() { Sinks::all().each(&TopicSink::beforeFork); }
void unlockStores(bool InChild) {
  Sinks::all().each(&TopicSink::afterFork, InChild);
}

} // namespace tpc
