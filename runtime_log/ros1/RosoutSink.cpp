//===- RosoutSink.cpp -----------------------------------------------------===//
#include "Runtime.h"
#include "Sink.h"
#include "ros1/RosLife.h"

#include <ros/console.h>
#include <ros/init.h>

#include <atomic>

namespace tpc {
namespace {

/// The sink of the thesis. roscpp does the rest: time stamp, queue, console.
class RosoutSink : public Sink {
public:
  void take(const Report &R) override {
    if (reaches(1))
      ROS_INFO("threshold_information:%s", format(R).c_str());
  }

  void take(const Summary &S) override {
    if (reaches(S.Count))
      ROS_INFO("threshold_summary:%s", format(S).c_str());
  }

  void take(const Dropped &D) override {
    if (reaches(0))
      ROS_INFO("threshold_dropped:%s", format(D).c_str());
  }

  void end() override {
    if (const uint64_t Count = Lost.exchange(0))
      warn(std::to_string(Count) +
           " evaluations came after ros::shutdown: they are not on /rosout");
  }

  std::string status() const override {
    const uint64_t Count = Lost;
    return Count ? "not_sent=" + std::to_string(Count) : "";
  }

private:
  /// Whether roscpp's console still takes messages; counts those that it would
  /// not. In a child that was forked from a node, the thread that empties its
  /// queue is missing: messages would pile up until the memory is full.
  bool reaches(uint64_t Evaluations) {
    if (forkedFromNode()) {
      warnOfFork("/rosout");
      return false;
    }
    if (!ros::isShuttingDown())
      return true;
    Lost += Evaluations;
    return false;
  }

  std::atomic<uint64_t> Lost{0};
};

} // namespace

Sink &rosoutSink() {
  // Never destroyed: threads may report until the very end.
  static Sink &Only = *new RosoutSink;
  return Only;
}

} // namespace tpc
