//===- Ros2.cpp - What the log library calls ------------------------------===//
#include "Clock.h"
#include "HostCalls.h"
#include "RclState.h"
#include "ReadNames.h"
#include "Runtime.h"
#include "ros2/Arguments.h"
#include "ros2/RclChannel.h"
#include "ros2/RclGraph.h"
#include "ros2/Settings.h"

#include <atomic>
#include <utility>

using namespace tpc;

namespace {

constexpr int64_t Ms = 1'000'000;
constexpr int64_t SoonNs = 20 * Ms;
constexpr int64_t LateNs = 250 * Ms;
/// A node has taken up simulated time by then, if it does.
constexpr int64_t StartNs = 1'000 * Ms;
/// For this many polls, looks often whether there is a node; after that seldom.
constexpr int SoonPolls = 500;

class Ros2 final : public Backend {
public:
  Ros2() {
    if (std::string Why = RclGraph::mismatch(); !Why.empty())
      Failure = new std::string(std::move(Why));
  }

  int64_t poll() override;
  void end(bool IsInterrupted) override;
  bool isForked() override { return Graph.isForked(); }
  const char *nodeName() override { return Graph.name(); }
  bool timeIsSimulated() override { return State.IsSimulated; }
  int64_t now() override;
  std::string resolveName(const void *, const std::string &Name) override;
  Channel &channel(SinkKind K) override { return rclChannel(K); }
  std::string failure() override {
    const std::string *Why = Failure;
    return Why ? *Why : "";
  }

private:
  void begin();
  void nameProcess();

  RclGraph &Graph = RclGraph::of();
  const RclState &State = host().rcl();
  int Polls = 0;         // by the helper thread
  int64_t FirstPoll = 0; // by the helper thread
  std::atomic<bool> TimeIsKnown{false};
  std::atomic<const std::string *> Failure{nullptr}; ///< never freed
};

void Ros2::begin() {
  std::string Why;
  const std::string Name = Graph.name();
  if (!Graph.begin(Name, Why) || !beginSettings(Name, Why))
    Failure = new std::string(Why);
}

/// Names a process that may have made a node before this library was there.
void Ros2::nameProcess() {
  if (!State.IsLate)
    return;
  const int64_t Now = Clock::steady();
  if (!FirstPoll)
    FirstPoll = Now;
  if (isNamedByCommandLine())
    return Graph.setName(nameByCommandLine());
  if (Now - FirstPoll < StartNs)
    return;
  const char *Later = State.LateNode;
  Graph.setName(Later ? Later : nameByCommandLine());
}

int64_t Ros2::poll() {
  if (Failure || Graph.isForked())
    return -1;
  try {
    if (!Graph.isUp()) {
      if (!*Graph.name())
        nameProcess();
      if (!*Graph.name())
        return Polls < SoonPolls ? (++Polls, SoonNs) : LateNs;
      begin();
      return SoonNs;
    }
    return serveSettings() ? -1 : LateNs;
  } catch (...) {
    return LateNs;
  }
}

void Ros2::end(bool IsInterrupted) {
  if (IsInterrupted || !Graph.isUp() || Graph.isForked())
    return;
  endRclChannels();
  endSettings();
  Graph.end();
}

int64_t Ros2::now() {
  if (State.IsSimulated)
    return State.SimulatedNs;
  if (!TimeIsKnown) {
    if (!*Graph.name() || Clock::steady() - State.NodeSince < StartNs)
      return 0;
    TimeIsKnown = true;
  }
  return Clock::real();
}

/// The names of parameters are relative to the node, and have dots. A handle
/// that is not known may be that of any node of this process.
std::string Ros2::resolveName(const void *Handle, const std::string &Name) {
  if (Handle && (State.Nodes != 1 || State.IsLate))
    return "";
  const std::string Node = Graph.name();
  return Node.empty() || Name.empty() ? "" : Node + "/" + Name;
}

} // namespace

Backend *tpc_make_backend(Host &Of) {
  setHost(Of);
  static auto &Only = *new Ros2;
  return &Only;
}
