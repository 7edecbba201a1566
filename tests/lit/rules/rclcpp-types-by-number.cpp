// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-param-calls>,print<tpc-gather-results>' %t.o | FileCheck %s
// RUN: %compile -O0 %s -o %t.0.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-param-calls>,print<tpc-gather-results>' %t.0.o | FileCheck %s
//
// get_value and get may have the number of a type instead of the type, and a
// ParameterValue may be a copy of that of a parameter.
#include <rclcpp/rclcpp.hpp>

class Node : public rclcpp::Node {
public:
  Node() : rclcpp::Node("node") {
    // CHECK-DAG: parameter reads of {{.*}}: 2
    // CHECK-DAG: get_parameter 'most' long
    Most = get_parameter("most").get_value<rclcpp::PARAMETER_INTEGER>();
    // CHECK-DAG: get_parameter 'far' double
    const rclcpp::ParameterValue Copy =
        get_parameter("far").get_parameter_value();
    Far = Copy.get<rclcpp::PARAMETER_DOUBLE>();
    Out = create_publisher<std_msgs::msg::Number>("out", 1);
  }
  // CHECK-DAG: comparisons of {{.*}}: 2
  void step(double V, int64_t N) {
    // CHECK-DAG: parameter 'most' relation < as x distance 1 {{.*}} at [[#@LINE+1]]:11
    if (N < Most)
      Out->publish(std_msgs::msg::Number());
    // CHECK-DAG: parameter 'far' relation > as x distance 1 {{.*}} at [[#@LINE+1]]:11
    if (V > Far)
      Out->publish(std_msgs::msg::Number());
  }

private:
  std::shared_ptr<rclcpp::Publisher<std_msgs::msg::Number>> Out;
  int64_t Most;
  double Far;
};

void run(double V) { Node().step(V, 3); }
