// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
// RUN: %compile -O0 %s -o %t.0.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.0.o | FileCheck %s
//
// A list of parameters that is assigned, to a member or to a local.
#include <rclcpp/rclcpp.hpp>

using Number = std_msgs::msg::Number;

class Node : public rclcpp::Node {
public:
  Node() : rclcpp::Node("node") {
    Out = create_publisher<Number>("out", 1);
    All = get_parameters({"a", "b"});
  }
  // CHECK: comparisons of {{.*}}: 4
  void step(double V) {
    // CHECK-DAG: parameter 'a' relation > {{.*}} at [[#@LINE+1]]:11
    if (V > All[0].as_double())
      Out->publish(Number());
    std::vector<rclcpp::Parameter> Local;
    Local = get_parameters({"c", "d"});
    // CHECK-DAG: parameter 'd' relation > {{.*}} at [[#@LINE+1]]:11
    if (V > Local[1].as_double())
      Out->publish(Number());
    auto Twice = get_parameters({"e", "f"});
    Twice = get_parameters({"g", "h"});
    // CHECK-DAG: parameter 'e' relation > {{.*}} at [[#@LINE+2]]:11
    // CHECK-DAG: parameter 'g' relation > {{.*}} at [[#@LINE+1]]:11
    if (V > Twice[0].as_double())
      Out->publish(Number());
  }

private:
  std::vector<rclcpp::Parameter> All;
  std::shared_ptr<rclcpp::Publisher<Number>> Out;
};

void run(double V) { Node().step(V); }
