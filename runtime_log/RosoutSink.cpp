//===- RosoutSink.cpp -----------------------------------------------------===//
#include "Sink.h"

#include <ros/console.h>

namespace tpc {

void logToRosout(const Report &R) {
  ROS_INFO("threshold_information:%s", format(R).c_str());
}

} // namespace tpc
