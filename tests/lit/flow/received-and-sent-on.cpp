// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// A message that a callback gets by a unique pointer, changes and sends on: the
// pointer is an argument of a function that a library calls, and is moved as
// bytes.
#include <rclcpp/rclcpp.hpp>

using std_msgs::msg::Number;

class Node : public rclcpp::Node {
public:
  Node() : rclcpp::Node("node") {
    Low = declare_parameter<double>("low", -1.5);
    Noted = declare_parameter<double>("noted", 1.5);
    Out = create_publisher<Number>("out", 1);
  }
  // CHECK: comparisons of {{.*}}: 1
  virtual void received(std::unique_ptr<Number> Message) {
    // CHECK-NEXT: parameter 'low' relation < {{.*}} at [[#@LINE+1]]:23
    if (Message->data < Low)
      Message->data = Low;
    if (Message->data > Noted)
      ++Count;
    Out->publish(std::move(Message));
  }

private:
  std::shared_ptr<rclcpp::Publisher<Number>> Out;
  double Low, Noted;
  int Count = 0;
};

std::shared_ptr<rclcpp::Node> make() { return std::make_shared<Node>(); }
