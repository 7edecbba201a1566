// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
// RUN: %compile -O0 %s -o %t.0.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.0.o | FileCheck %s
//
// LifecyclePublisher::publish is virtual: a call through the pointer to it, or
// to a class that derives from it, exposes, and so does ending the lifecycle
// state. A class with an override of its own exposes what that publishes.
#include <rclcpp_lifecycle/lifecycle_node.hpp>

using Number = std_msgs::msg::Number;

class Counting : public rclcpp_lifecycle::LifecyclePublisher<Number> {
public:
  int Count = 0;
};

class Limited : public rclcpp_lifecycle::LifecyclePublisher<Number> {
public:
  void publish(const Number &Message) override {
    // CHECK-DAG: parameter 'c' relation > as x distance 1 {{.*}} at [[#@LINE+1]]:22
    if (Message.data > Limit)
      rclcpp_lifecycle::LifecyclePublisher<Number>::publish(Message);
  }
  double Limit = 0;
};

class Node : public rclcpp_lifecycle::LifecycleNode {
public:
  Node() : rclcpp_lifecycle::LifecycleNode("node") {
    A = get_parameter("a").as_double();
    B = get_parameter("b").as_double();
    Third->Limit = get_parameter("c").as_double();
    D = get_parameter("d").as_double();
    Out = create_publisher<Number>("out", 1);
  }
  // CHECK-DAG: comparisons of {{.*}}: 4
  void step(double V) {
    Number M;
    M.data = V;
    // CHECK-DAG: parameter 'a' relation > as x distance 1 {{.*}} at [[#@LINE+1]]:11
    if (V > A)
      Out->publish(M);
    // CHECK-DAG: parameter 'b' relation > as x distance 1 {{.*}} at [[#@LINE+1]]:11
    if (V > B)
      Second->publish(M);
    Third->publish(M);
    // CHECK-DAG: parameter 'd' relation > as x distance 1 {{.*}} at [[#@LINE+1]]:11
    if (V > D)
      deactivate();
  }

private:
  std::shared_ptr<rclcpp_lifecycle::LifecyclePublisher<Number>> Out;
  std::shared_ptr<Counting> Second = std::make_shared<Counting>();
  std::shared_ptr<Limited> Third = std::make_shared<Limited>();
  double A, B, D;
};

void run(double V) { Node().step(V); }
