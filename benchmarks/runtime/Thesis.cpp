//===- Thesis.cpp - A report as the thesis makes it
//------------------------===//
//
// As in the thesis (docs/reference/runtime.md): a stream for the line, and ROS_INFO for the stream.
//
//===----------------------------------------------------------------------===//
#include "ByHand.h"

#include <ros/console.h>
#include <sstream>

char Reporting = 1;

void log_one(char *key, bool result, double cmp, double thresh, bool res) {
  std::stringstream Line;
  Line << "threshold_information:" << key << "," << result << ",cmp:" << cmp
       << ",thresh:" << thresh << ",res:" << res;
  ROS_INFO("%s", Line.str().c_str());
}
