// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
// RUN: %compile -O0 %s -o %t.0.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.0.o | FileCheck %s
//
// What `find` finds in a map of parameters has the name of the key; an iterator that
// moves on leads to others, too.
#include <rclcpp/rclcpp.hpp>

using Number = std_msgs::msg::Number;

// CHECK: comparisons of {{.*}}: 3
void run(rclcpp::Node &Of, rclcpp::Publisher<Number> &Out, double V,
         const std::string &Key) {
  std::map<std::string, double> Limits;
  Of.get_parameters("limits", Limits);
  const auto It = Limits.find("high");
  // CHECK-DAG: parameter 'limits.high' relation > {{.*}} at [[#@LINE+1]]:31
  if (It != Limits.end() && V > It->second)
    Out.publish(Number());
  // CHECK-DAG: parameter 'limits.<dynamic>' relation < {{.*}} at [[#@LINE+1]]:9
  if (V < Limits.find(Key)->second)
    Out.publish(Number());
  // CHECK-DAG: parameter 'limits.<dynamic>' relation < {{.*}} at [[#@LINE+2]]:11
  for (auto From = Limits.find("low"); From != Limits.end(); ++From)
    if (V < From->second)
      Out.publish(Number());
}
