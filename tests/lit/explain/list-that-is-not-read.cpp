// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes=tpc -tpc-link-unit=node -tpc-static-info=%t.json %t.o
// RUN: FileCheck %s --input-file=%t.json
//
// A list that a call returns and that nothing reads is a blind spot without a
// variable.
// CHECK: "failure": null
#include <rclcpp/rclcpp.hpp>

void run(rclcpp::Node &Of, rclcpp::Publisher<std_msgs::msg::Number> &Out,
         double V) {
  Of.get_parameter("list").as_double_array();
  if (V > Of.get_parameter("limit").as_double())
    Out.publish(std_msgs::msg::Number());
}
