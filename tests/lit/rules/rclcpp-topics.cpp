// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-extern-calls>' %t.o | FileCheck %s
// RUN: %compile -O0 %s -o %t.0.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-extern-calls>' %t.0.o | FileCheck %s
//
// The topic of a publisher that is kept in a std::shared_ptr, and what the
// classes of rclcpp publish about themselves, which is no output of the robot.
#include <rclcpp/rclcpp.hpp>

using Pointer = std::shared_ptr<rclcpp::Publisher<std_msgs::msg::Number>>;

class Node : public rclcpp::Node {
public:
  explicit Node(bool Which) : rclcpp::Node("node") {
    A = create_publisher<std_msgs::msg::Number>("first", 1);
    auto Local = create_publisher<std_msgs::msg::Number>("second", 1);
    B = Local;
    C = Which ? A : B;
  }
  // CHECK: exposing statements of {{.*}}: 4
  void step() {
    std_msgs::msg::Number M;
    // CHECK-DAG: publish topic 'first' in {{.*}} at [[#@LINE+1]]:8
    A->publish(M);
    // CHECK-DAG: publish topic 'second' in {{.*}} at [[#@LINE+1]]:8
    B->publish(M);
    // CHECK-DAG: publish topic '' in {{.*}} at [[#@LINE+1]]:8
    C->publish(M);
    other(A);
    rclcpp::topic_statistics::SubscriptionTopicStatistics(*A)
        .publish_message_and_reset_measurements(1);
  }
  void other(Pointer To) {
    // CHECK-DAG: publish topic 'first' in {{.*}} at [[#@LINE+1]]:9
    To->publish(std_msgs::msg::Number());
  }

private:
  Pointer A, B, C;
};

void run(bool Which) { Node(Which).step(); }
