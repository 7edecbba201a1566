// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
// RUN: %compile -O0 %s -o %t.0.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.0.o | FileCheck %s
//
// A list of names gives a list of parameters in the same order.
#include <rclcpp/rclcpp.hpp>

using Number = std_msgs::msg::Number;

// CHECK: comparisons of {{.*}}: 9
void run(rclcpp::Node &Of, rclcpp::Publisher<Number> &Out, double V,
         const std::vector<std::string> &Unknown) {
  const auto All = Of.get_parameters({"a", "b", "c"});
  // CHECK-DAG: parameter 'a' relation > {{.*}} at [[#@LINE+1]]:9
  if (V > All[0].as_double())
    Out.publish(Number());
  // CHECK-DAG: parameter 'b' relation > {{.*}} at [[#@LINE+1]]:9
  if (V > All.at(1).get_value<double>())
    Out.publish(Number());
  // CHECK-DAG: parameter 'c' relation > {{.*}} at [[#@LINE+2]]:9
  const rclcpp::Parameter Third = All[2];
  if (V > Third.as_double())
    Out.publish(Number());
  // In a loop, either of them.
  for (const rclcpp::Parameter &P : Of.get_parameters({"d", "e"}))
    // CHECK-DAG: parameter 'd' relation < {{.*}} at [[#@LINE+2]]:11
    // CHECK-DAG: parameter 'e' relation < {{.*}} at [[#@LINE+1]]:11
    if (V < P.as_double())
      Out.publish(Number());
  for (const rclcpp::Parameter &P : Of.get_parameters({"f", "g"}))
    if (P.get_name() == "f") {
      // CHECK-DAG: parameter 'f' relation < {{.*}} at [[#@LINE+1]]:13
      if (V < P.as_double())
        Out.publish(Number());
    }
  for (const rclcpp::Parameter &P : Of.get_parameters({"h"}))
    // CHECK-DAG: parameter 'h' relation < {{.*}} at [[#@LINE+1]]:11
    if (V < P.as_double())
      Out.publish(Number());
  // CHECK-DAG: parameter '<dynamic>' relation < {{.*}} at [[#@LINE+1]]:9
  if (V < Of.get_parameters(Unknown)[0].as_double())
    Out.publish(Number());
  // CHECK-DAG: parameter 'i' relation < {{.*}} at [[#@LINE+2]]:9
  const std::vector<std::string> Names{"i"};
  if (V < Of.get_parameters(Names)[0].as_double())
    Out.publish(Number());
}
