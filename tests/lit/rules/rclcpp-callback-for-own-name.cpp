// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
// RUN: %compile -O0 %s -o %t.0.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.0.o | FileCheck %s
//
// A handler that is told this node's own name gets this node's parameters.
#include <rclcpp/rclcpp.hpp>

using Number = std_msgs::msg::Number;

class Node : public rclcpp::Node {
public:
  Node() : rclcpp::Node("node"), Events(this) {
    Own = Events.add_parameter_callback(
        "a", [this](const rclcpp::Parameter &P) { A = P.as_double(); },
        "/ns/node");
    Out = create_publisher<Number>("out", 1);
  }
  // CHECK: comparisons of {{.*}}: 1
  void step(double V) {
    // CHECK: parameter 'a' relation > {{.*}} at [[#@LINE+1]]:11
    if (V > A)
      Out->publish(Number());
  }

private:
  rclcpp::ParameterEventHandler Events;
  std::shared_ptr<void> Own;
  std::shared_ptr<rclcpp::Publisher<Number>> Out;
  double A = 1;
};

void run(double V) { Node().step(V); }
