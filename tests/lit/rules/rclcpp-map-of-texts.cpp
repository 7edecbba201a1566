// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
// RUN: %compile -O0 %s -o %t.0.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.0.o | FileCheck %s
//
// The texts in a map of parameters have the name of the key, if it is the one way in
// which the program gets at them. The analysis does not tell them apart.
#include <rclcpp/rclcpp.hpp>

using Number = std_msgs::msg::Number;

// CHECK: comparisons of {{.*}}: 5
void run(rclcpp::Node &Of, rclcpp::Publisher<Number> &Out) {
  std::map<std::string, std::string> One, Two, All;
  Of.get_parameters("one", One);
  Of.get_parameters("two", Two);
  Of.get_parameters("all", All);
  // CHECK-DAG: parameter 'one.mode' relation == {{.*}} at [[#@LINE+1]]:19
  if (One["mode"] == "x")
    Out.publish(Number());
  // CHECK-DAG: parameter 'two.<dynamic>' relation == {{.*}} at [[#@LINE+1]]:19
  if (Two["mode"] == "x")
    Out.publish(Number());
  // CHECK-DAG: parameter 'two.<dynamic>' relation == {{.*}} at [[#@LINE+2]]:14
  for (const auto &[Key, Text] : Two)
    if (Text == "y")
      Out.publish(Number());
  // CHECK-DAG: parameter 'all.<dynamic>' relation == {{.*}} at [[#@LINE+2]]:14
  for (const auto &[Key, Text] : All)
    if (Text == "z")
      Out.publish(Number());
  std::map<std::string, std::string> Found;
  Of.get_parameters("found", Found);
  const auto It = Found.find("kind");
  // CHECK-DAG: parameter 'found.kind' relation == {{.*}} at [[#@LINE+1]]:39
  if (It != Found.end() && It->second == "w")
    Out.publish(Number());
}
