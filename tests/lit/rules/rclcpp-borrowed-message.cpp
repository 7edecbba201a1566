// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
// RUN: %compile -O0 %s -o %t.0.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.0.o | FileCheck %s
//
// What is written into a message that is borrowed from the publisher is
// published with it.
#include <rclcpp/rclcpp.hpp>

using Number = std_msgs::msg::Number;

// CHECK: comparisons of {{.*}}: 1
void run(rclcpp::Node &Of, rclcpp::Publisher<Number> &Out, double V) {
  const double Limit = Of.declare_parameter("a", 1.0);
  const double Kept = Of.declare_parameter("b", 2.0);
  auto Sent = Out.borrow_loaned_message();
  auto NotSent = Out.borrow_loaned_message();
  // CHECK-DAG: parameter 'a' relation > {{.*}} at [[#@LINE+1]]:9
  if (V > Limit)
    Sent.get().data = 2 * V;
  if (V > Kept)
    NotSent.get().data = V;
  Out.publish(std::move(Sent));
}
