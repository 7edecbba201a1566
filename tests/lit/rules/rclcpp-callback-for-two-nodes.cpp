// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
// RUN: %compile -O0 %s -o %t.0.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.0.o | FileCheck %s
//
// A function that is called back for this node's and for another node's parameter
// of the same name has that name.
#include <rclcpp/rclcpp.hpp>

using Number = std_msgs::msg::Number;

class Node : public rclcpp::Node {
public:
  Node() : rclcpp::Node("node"), Events(this) {
    auto Own = [this](const rclcpp::Parameter &P) { A = P.as_double(); };
    Near = Events.add_parameter_callback("a", Own);
    Far = Events.add_parameter_callback("a", Own, "/far");
    auto Other = [this](const rclcpp::Parameter &P) { B = P.as_double(); };
    Far = Events.add_parameter_callback("c", Other, "/far");
    Near = Events.add_parameter_callback("b", Other);
    Out = create_publisher<Number>("out", 1);
  }
  // CHECK: comparisons of {{.*}}: 2
  void step(double V) {
    // CHECK-DAG: parameter 'a' relation > {{.*}} at [[#@LINE+1]]:11
    if (V > A)
      Out->publish(Number());
    // CHECK-DAG: parameter 'b' relation > {{.*}} at [[#@LINE+1]]:11
    if (V > B)
      Out->publish(Number());
  }

private:
  rclcpp::ParameterEventHandler Events;
  std::shared_ptr<void> Near, Far;
  std::shared_ptr<rclcpp::Publisher<Number>> Out;
  double A = 1, B = 1;
};

void run(double V) { Node().step(V); }
