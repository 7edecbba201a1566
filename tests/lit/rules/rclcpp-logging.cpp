// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
// RUN: %compile -O0 %s -o %t.0.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.0.o | FileCheck %s
//
// Log output is not exposed: a logger that is released ends no node, although
// shared pointers release both by the same function, and asking the node for
// its clock does not change what its publisher shows.
#include <rclcpp/rclcpp.hpp>

class Node : public rclcpp::Node {
public:
  Node() : rclcpp::Node("node") {
    Limit = declare_parameter<double>("limit", 1.5);
    Noted = declare_parameter<double>("noted", 2.5);
    Timed = declare_parameter<double>("timed", 3.5);
  }
  void connect() {
    Out = create_generic_publisher("out", "std_msgs/msg/Number", 1);
  }
  // CHECK-DAG: comparisons of {{.*}}: 1
  void step(double V) {
    if (V > Noted)
      get_logger().log("noted");
    if (V > Timed)
      get_clock();
    // CHECK-DAG: parameter 'limit' relation > as x distance 1 {{.*}} at [[#@LINE+1]]:11
    if (V > Limit)
      Out->publish(rclcpp::SerializedMessage());
  }

private:
  std::shared_ptr<rclcpp::GenericPublisher> Out;
  double Limit, Noted, Timed;
};

void run(double V) {
  auto Made = std::make_shared<Node>();
  Made->connect();
  Made->step(V);
}
