// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
// RUN: %compile -O0 %s -o %t.0.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.0.o | FileCheck %s
//
// A duration may be made of seconds and nanoseconds: both are followed.
#include <rclcpp/rclcpp.hpp>

class Node : public rclcpp::Node {
public:
  Node() : rclcpp::Node("node") {
    Milliseconds = declare_parameter<int64_t>("a", 500);
    Seconds = declare_parameter<int64_t>("b", 3);
    Out = create_publisher<std_msgs::msg::Number>("out", 1);
  }
  // CHECK: comparisons of {{.*}}: 4
  void step(const rclcpp::Duration &Age, int Unknown) {
    std_msgs::msg::Number M;
    // 1e6 / 1e9 of the milliseconds.
    // CHECK-DAG: derived 'a' relation < as 0.001 * x distance 1 {{.*}} at [[#@LINE+1]]:13
    if (Age < rclcpp::Duration(0, Milliseconds * 1000000))
      Out->publish(M);
    // CHECK-DAG: derived 'a' relation < as 0.001 * x + 2 distance 1 {{.*}} at [[#@LINE+1]]:13
    if (Age < rclcpp::Duration(2, Milliseconds * 1000000))
      Out->publish(M);
    // CHECK-DAG: parameter 'b' relation < as x distance 1 {{.*}} at [[#@LINE+1]]:13
    if (Age < rclcpp::Duration(Seconds, 0))
      Out->publish(M);
    // CHECK-DAG: derived 'b' relation < as x + 0.5 distance 1 {{.*}} at [[#@LINE+1]]:13
    if (Age < rclcpp::Duration(Seconds, 500000000))
      Out->publish(M);
    // The nanoseconds alone are no threshold.
    if (Age < rclcpp::Duration(Unknown, Milliseconds * 1000000))
      Out->publish(M);
  }

private:
  std::shared_ptr<rclcpp::Publisher<std_msgs::msg::Number>> Out;
  int Milliseconds, Seconds;
};

void run(const rclcpp::Duration &Age, int Unknown) {
  Node().step(Age, Unknown);
}
