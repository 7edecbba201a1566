// RUN: %compile -O2 -w %s -o %t.o
// RUN: %opt -disable-output -passes=tpc -tpc-static-info=%t.json %t.o
// RUN: %python %inputs/show.py messages %t.json | FileCheck %s --match-full-lines
//
// The topics of a node of ROS 2: its callbacks are lambdas and bound methods,
// which the subscription keeps.
#include <rclcpp/rclcpp.hpp>

namespace example::msg {
template <class A> struct Level_ {
  double data = 0;
};
using Level = Level_<std::allocator<void>>;
} // namespace example::msg

using example::msg::Level;

class Node : public rclcpp::Node {
public:
  Node() : rclcpp::Node("node") {
    Low = declare_parameter<double>("low", -1.5);
    High = declare_parameter<double>("high", 1.5);
    Out = create_publisher<Level>("out", 1);
    create_subscription<Level>("~/near", 1, [this](std::shared_ptr<Level> M) {
      // CHECK-DAG: low: out example/msg/Level <- ~near example/msg/Level value
      if (M->data < Low)
        Out->publish(*M);
    });
    create_subscription<Level>(
        "far", 1, std::bind(&Node::far, this, std::placeholders::_1));
  }
  void far(std::shared_ptr<const Level> M) {
    Level To;
    // CHECK-DAG: high: out example/msg/Level <- far example/msg/Level value
    if (M->data > High)
      Out->publish(To);
  }

private:
  std::shared_ptr<rclcpp::Publisher<Level>> Out;
  double Low, High;
};

std::shared_ptr<rclcpp::Node> make() { return std::make_shared<Node>(); }
