// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
// RUN: %compile -O0 %s -o %t.0.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.0.o | FileCheck %s
//
// Texts and lists that a method of rclcpp::Parameter returns by reference, and
// those that a read returns or writes.
#include <rclcpp/rclcpp.hpp>

class Node : public rclcpp::Node {
public:
  Node() : rclcpp::Node("node") {
    get_parameter("a", A);
    B = get_parameter("b").as_string();
    C = get_parameter("c").as_double_array();
    Out = create_publisher<std_msgs::msg::Number>("out", 1);
  }
  // CHECK-DAG: comparisons of {{.*}}: 6
  void step(double V) {
    std_msgs::msg::Number M;
    // CHECK-DAG: parameter 'a' relation == as x distance 1 {{.*}} at [[#@LINE+1]]:11
    if (A == "fast")
      Out->publish(M);
    // CHECK-DAG: parameter 'b' relation == as x distance 1 {{.*}} at [[#@LINE+1]]:11
    if (B == "fast")
      Out->publish(M);
    // CHECK-DAG: parameter 'd' relation == as x distance 1 {{.*}} at [[#@LINE+1]]:40
    if (get_parameter("d").as_string() == "fast")
      Out->publish(M);
    // CHECK-DAG: derived 'c' relation > as x[] distance 1 {{.*}} at [[#@LINE+1]]:11
    if (V > C[1])
      Out->publish(M);
    // CHECK-DAG: derived 'c' relation < as size(x) distance 1 {{.*}} at [[#@LINE+1]]:18
    if (C.size() > 3)
      Out->publish(M);
    // CHECK-DAG: derived 'e' relation > as x[] distance 1 {{.*}} at [[#@LINE+1]]:11
    if (V > get_parameter("e").as_double_array()[0])
      Out->publish(M);
  }

private:
  std::shared_ptr<rclcpp::Publisher<std_msgs::msg::Number>> Out;
  std::string A, B;
  std::vector<double> C;
};

void run(double V) { Node().step(V); }
