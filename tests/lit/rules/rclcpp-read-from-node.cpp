// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// The value of a parameter does not depend on what else is done to the node.
#include <rclcpp/rclcpp.hpp>

static double Timed;

// CHECK: comparisons of {{.*}}: 1
void choose(double V, rclcpp::Node &Of) {
  if (V > Timed)
    Of.get_clock();
}

void step(double V, rclcpp::Node &Of,
          rclcpp::Publisher<std_msgs::msg::Number> &Out) {
  double Limit = 0;
  Of.get_parameter("limit", Limit);
  // CHECK: parameter 'limit' relation > as x distance 1 {{.*}} at [[#@LINE+1]]:9
  if (V > Limit)
    Out.publish(std_msgs::msg::Number());
}

void run(double V, rclcpp::Publisher<std_msgs::msg::Number> &Out) {
  rclcpp::Node Made("node");
  Timed = Made.declare_parameter<double>("timed", 3.5);
  choose(V, Made);
  step(V, Made, Out);
}
