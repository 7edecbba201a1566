//===- RosoutSink.cpp -----------------------------------------------------===//
#include "Sink.h"

#include <ros/console.h>

namespace tpc {

namespace {

class RosoutSink final : public Sink {
public:
  void take(const Report &R) override {
    ROS_INFO("threshold_information:%s", format(R).c_str());
  }
  void take(const Summary &S) override {
    ROS_INFO("threshold_summary:%s", format(S).c_str());
  }
  void take(const Dropped &D) override {
    ROS_INFO("threshold_dropped:%s", format(D).c_str());
  }
};

} // namespace

Sink &rosoutSink() {
  static auto *S = new RosoutSink;
  return *S;
}

} // namespace tpc
