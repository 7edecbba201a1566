// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
// RUN: %compile -O0 %s -o %t.0.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.0.o | FileCheck %s
//
// An rclcpp::Duration or rclcpp::Time holds a number of seconds: in its
// operators, after copies, and in nanoseconds.
#include <rclcpp/rclcpp.hpp>

class Node : public rclcpp::Node {
public:
  Node() : rclcpp::Node("node") {
    Patience = rclcpp::Duration::from_seconds(declare_parameter("a", 1.5));
    Pause = rclcpp::Duration::from_nanoseconds(declare_parameter<int64_t>("b", 7));
    Seconds = declare_parameter("c", 2.5);
    Out = create_publisher<std_msgs::msg::Number>("out", 1);
  }
  // CHECK-DAG: comparisons of {{.*}}: 7
  void step() {
    std_msgs::msg::Number M;
    // CHECK-DAG: parameter 'a' relation > as x distance 1 {{.*}} at [[#@LINE+1]]:22
    if (now() - Last > Patience)
      Out->publish(M);
    // CHECK-DAG: derived 'a' relation > as x + Last distance 1 {{.*}} at [[#@LINE+1]]:15
    if (now() > Last + Patience)
      Out->publish(M);
    // CHECK-DAG: derived 'a' relation < as 2 * x distance 1 {{.*}} at [[#@LINE+1]]:22
    if (Patience * 2 > now() - Last)
      Out->publish(M);
    // CHECK-DAG: derived 'b' relation > as 1e-09 * x distance 1 {{.*}} at [[#@LINE+1]]:22
    if (now() - Last > Pause)
      Out->publish(M);
    // CHECK-DAG: derived 'a' relation > as 1e+09 * x distance 1 {{.*}} at [[#@LINE+1]]:38
    if ((now() - Last).nanoseconds() > Patience.nanoseconds())
      Out->publish(M);
    // CHECK-DAG: parameter 'c' relation > as x distance 1 {{.*}} at [[#@LINE+1]]:34
    if ((now() - Last).seconds() > Seconds)
      Out->publish(M);
    // CHECK-DAG: parameter 'c' relation > as x distance 1 {{.*}} at [[#@LINE+1]]:22
    if (now() - Last > rclcpp::Duration::from_seconds(Seconds))
      Out->publish(M);
    Last = now();
  }

private:
  std::shared_ptr<rclcpp::Publisher<std_msgs::msg::Number>> Out;
  rclcpp::Duration Patience{0, 0}, Pause{0, 0};
  rclcpp::Time Last;
  double Seconds;
};

void run() { Node().step(); }
