// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-param-calls>,print<tpc-gather-results>' %t.o | FileCheck %s
// RUN: %compile -O0 %s -o %t.0.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-param-calls>,print<tpc-gather-results>' %t.0.o | FileCheck %s
//
// A handler that is told the name of another node gets that node's parameters.
#include <rclcpp/rclcpp.hpp>

class Node : public rclcpp::Node {
public:
  explicit Node(const std::string &Other) : rclcpp::Node("node"), Events(this) {
    Near = Events.add_parameter_callback(
        "a", [this](const rclcpp::Parameter &P) { A = P.as_double(); });
    Far = Events.add_parameter_callback(
        "b", [this](const rclcpp::Parameter &P) { B = P.as_double(); }, "/far");
    // May be the own name.
    Any = Events.add_parameter_callback(
        "c", [this](const rclcpp::Parameter &P) { C = P.as_double(); }, Other);
    Out = create_publisher<std_msgs::msg::Number>("out", 1);
  }
  // CHECK: parameter reads of {{.*}}: 2
  // CHECK-DAG: Parameter::as_double 'a' double
  // CHECK-DAG: Parameter::as_double 'c' double
  // CHECK: comparisons of {{.*}}: 2
  void step(double V) {
    std_msgs::msg::Number M;
    // CHECK-DAG: parameter 'a' relation > {{.*}} at [[#@LINE+1]]:11
    if (V > A)
      Out->publish(M);
    if (V > B)
      Out->publish(M);
    // CHECK-DAG: parameter 'c' relation > {{.*}} at [[#@LINE+1]]:11
    if (V > C)
      Out->publish(M);
  }

private:
  rclcpp::ParameterEventHandler Events;
  std::shared_ptr<void> Near, Far, Any;
  std::shared_ptr<rclcpp::Publisher<std_msgs::msg::Number>> Out;
  double A = 1, B = 1, C = 1;
};

void run(double V, const std::string &Other) { Node(Other).step(V); }
