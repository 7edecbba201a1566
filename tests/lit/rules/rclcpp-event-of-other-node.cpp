// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-param-calls>,print<tpc-gather-results>' %t.o | FileCheck %s
// RUN: %compile -O0 %s -o %t.0.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-param-calls>,print<tpc-gather-results>' %t.0.o | FileCheck %s
//
// A parameter that is taken out of an event is none of this node's if the program
// asks for another node's.
#include <rclcpp/rclcpp.hpp>

using Number = std_msgs::msg::Number;

using Event = rcl_interfaces::msg::ParameterEvent;
using Handler = rclcpp::ParameterEventHandler;

class Node : public rclcpp::Node {
public:
  Node() : rclcpp::Node("node") { Out = create_publisher<Number>("out", 1); }
  // CHECK: parameter reads of {{.*}}: 2
  // CHECK: comparisons of {{.*}}: 2
  void step(const Event &E, double V) {
    if (V > Handler::get_parameter_from_event(E, "far", "/far").as_double())
      Out->publish(Number());
    rclcpp::Parameter P;
    if (Handler::get_parameter_from_event(E, P, "far", "/ns/far") &&
        V > P.as_double())
      Out->publish(Number());
    // CHECK-DAG: parameter 'a' relation < {{.*}} at [[#@LINE+1]]:11
    if (V < Handler::get_parameter_from_event(E, "a", get_fully_qualified_name()).as_double())
      Out->publish(Number());
    rclcpp::Parameter Q;
    // CHECK-DAG: parameter 'b' relation < {{.*}} at [[#@LINE+2]]:11
    if (Handler::get_parameter_from_event(E, Q, "b", "/ns/node") &&
        V < Q.as_double())
      Out->publish(Number());
  }

private:
  std::shared_ptr<rclcpp::Publisher<Number>> Out;
};

void run(const Event &E, double V) { Node().step(E, V); }
