// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// A parameter of 64 bits that is kept in a smaller integer fits: what is
// computed with it afterwards is computed with the parameter.
#include <rclcpp/rclcpp.hpp>

class Node : public rclcpp::Node {
public:
  Node() : rclcpp::Node("node") {
    Every = declare_parameter<int64_t>("every", 2);
    Width = declare_parameter<int64_t>("width", 6);
    Out = create_publisher<std_msgs::msg::Number>("out", 1);
  }
  // CHECK-DAG: comparisons of {{.*}}: 2
  void step(int V) {
    // CHECK-DAG: derived 'every' relation == as {{.*}} rem x distance 1 {{.*}}
    // at [[#@LINE+1]]:25
    if (++Count % Every == 0)
      Out->publish(std_msgs::msg::Number());
    // CHECK-DAG: derived 'width' relation > as trunc(x / 2) distance 1 {{.*}}
    // at [[#@LINE+1]]:11
    if (V > Width / 2)
      Out->publish(std_msgs::msg::Number());
  }

private:
  std::shared_ptr<rclcpp::Publisher<std_msgs::msg::Number>> Out;
  int Every, Width, Count = 0;
};

void run(int V) { Node().step(V); }
