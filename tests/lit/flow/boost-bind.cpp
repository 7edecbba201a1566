// REQUIRES: ros1-headers
// RUN: %compile-real -O2 -w %s -o %t.o
// RUN: llvm-link %t.o -o %t.bc
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.bc | FileCheck %s
//
// Two thresholds that boost::bind stores are distinguished by their places,
// those of another bind object by its class, and a message that contains a
// double is not confused with a bound double.
#include <boost/bind/bind.hpp>
#include <ros/ros.h>
#include <std_msgs/Float64.h>

using std_msgs::Float64;

static void relay(const Float64::ConstPtr &Msg, double Limit, double Ceiling,
                  const ros::Publisher &Out) {
  // CHECK: comparisons of {{.*}}: 3
  // CHECK-DAG: parameter 'limit' relation < as x {{.*}} at [[#@LINE+1]]:17
  if (Msg->data < Limit)
    return;
  // CHECK-DAG: parameter 'ceiling' relation <= as x {{.*}} at [[#@LINE+1]]:15
  if (Ceiling >= Msg->data)
    Out.publish(Msg);
}

static void below(const Float64::ConstPtr &Msg, double Floor,
                  const ros::Publisher &Out) {
  // CHECK-DAG: parameter 'floor' relation < as x {{.*}} at [[#@LINE+1]]:17
  if (Msg->data < Floor)
    Out.publish(Msg);
}

int main(int Argc, char **Argv) {
  using namespace boost::placeholders;
  ros::init(Argc, Argv, "node");
  ros::NodeHandle Handle;
  double Limit, Ceiling, Floor;
  Handle.param("limit", Limit, 3.0);
  Handle.param("ceiling", Ceiling, 9.0);
  Handle.param("floor", Floor, -3.0);
  ros::Publisher Out = Handle.advertise<Float64>("out", 1);
  ros::Subscriber A = Handle.subscribe<Float64>(
      "in", 1, boost::bind(relay, _1, Limit, Ceiling, Out));
  ros::Subscriber B =
      Handle.subscribe<Float64>("in", 1, boost::bind(below, _1, Floor, Out));
  ros::spin();
}
