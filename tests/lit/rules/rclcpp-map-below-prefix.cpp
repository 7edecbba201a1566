// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
// RUN: %compile -O0 %s -o %t.0.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.0.o | FileCheck %s
//
// All parameters below a prefix fill a map: each has the name of its key.
#include <rclcpp/rclcpp.hpp>

using Number = std_msgs::msg::Number;

// CHECK: comparisons of {{.*}}: 5
void run(rclcpp::Node &Of, rclcpp::Publisher<Number> &Out, double V, int N,
         const std::string &Key) {
  std::map<std::string, double> Limits;
  std::map<std::string, int64_t> Counts;
  Of.get_parameters("limits", Limits);
  Of.get_parameters("counts", Counts);
  // CHECK-DAG: parameter 'limits.high' relation > {{.*}} at [[#@LINE+1]]:9
  if (V > Limits["high"])
    Out.publish(Number());
  // CHECK-DAG: parameter 'limits.low' relation < {{.*}} at [[#@LINE+1]]:9
  if (V < Limits.at("low"))
    Out.publish(Number());
  // CHECK-DAG: parameter 'limits.<dynamic>' relation < {{.*}} at [[#@LINE+1]]:9
  if (V < Limits[Key])
    Out.publish(Number());
  // CHECK-DAG: parameter 'counts.least' relation < {{.*}} at [[#@LINE+1]]:9
  if (N < Counts["least"])
    Out.publish(Number());
  // CHECK-DAG: parameter 'counts.<dynamic>' relation > {{.*}} at [[#@LINE+2]]:11
  for (const auto &[Name, Count] : Counts)
    if (N > Count)
      Out.publish(Number());
}
