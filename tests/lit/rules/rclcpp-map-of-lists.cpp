// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
// RUN: %compile -O0 %s -o %t.0.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.0.o | FileCheck %s
//
// The lists in a map of parameters: only the key names one of them, and only if it
// is the one key. The analysis does not tell them apart.
#include <rclcpp/rclcpp.hpp>

using Number = std_msgs::msg::Number;

// CHECK: comparisons of {{.*}}: 3
void run(rclcpp::Node &Of, rclcpp::Publisher<Number> &Out, double V) {
  std::map<std::string, std::vector<double>> One, Two;
  Of.get_parameters("one", One);
  Of.get_parameters("two", Two);
  // CHECK-DAG: derived 'one.high' relation > as x[] {{.*}} at [[#@LINE+1]]:9
  if (V > One["high"][0])
    Out.publish(Number());
  // CHECK-DAG: derived 'two.<dynamic>' relation > as x[] {{.*}} at [[#@LINE+1]]:9
  if (V > Two["high"][0])
    Out.publish(Number());
  // CHECK-DAG: derived 'two.<dynamic>' relation < as x[] {{.*}} at [[#@LINE+1]]:9
  if (V < Two["low"][0])
    Out.publish(Number());
}
