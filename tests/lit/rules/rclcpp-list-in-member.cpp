// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
// RUN: %compile -O0 %s -o %t.0.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.0.o | FileCheck %s
//
// A list of parameters that a member is made of.
#include <rclcpp/rclcpp.hpp>

using Number = std_msgs::msg::Number;

class Node : public rclcpp::Node {
public:
  Node() : rclcpp::Node("node"), All(get_parameters({"a", "b"})) {
    Out = create_publisher<Number>("out", 1);
  }
  // CHECK: comparisons of {{.*}}: 1
  void step(double V) {
    // CHECK: parameter 'b' relation > {{.*}} at [[#@LINE+1]]:11
    if (V > All[1].as_double())
      Out->publish(Number());
  }

private:
  const std::vector<rclcpp::Parameter> All;
  std::shared_ptr<rclcpp::Publisher<Number>> Out;
};

void run(double V) { Node().step(V); }
