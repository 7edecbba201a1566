// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
// RUN: %compile -O0 %s -o %t.0.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.0.o | FileCheck %s
//
// Of a list of names that the program changes, no name is known.
#include <rclcpp/rclcpp.hpp>

using Number = std_msgs::msg::Number;

// CHECK: comparisons of {{.*}}: 4
void run(rclcpp::Node &Of, rclcpp::Publisher<Number> &Out, double V, bool X) {
  std::vector<std::string> Names{"a"};
  if (X)
    Names.push_back("b");
  // CHECK-DAG: parameter '<dynamic>' relation > {{.*}} at [[#@LINE+1]]:9
  if (V > Of.get_parameters(Names)[0].as_double())
    Out.publish(Number());
  std::vector<std::string> Replaced{"c", "d"};
  Replaced[1] = "e";
  // CHECK-DAG: parameter '<dynamic>' relation > {{.*}} at [[#@LINE+1]]:9
  if (V > Of.get_parameters(Replaced)[1].as_double())
    Out.publish(Number());
  // One that is only looked at stays what it is.
  std::vector<std::string> Same{"f", "g"};
  // CHECK-DAG: parameter 'g' relation > {{.*}} at [[#@LINE+1]]:9
  if (V > Of.get_parameters(Same)[1].as_double())
    Out.publish(Number());
  std::vector<std::string> Asked{"h"};
  // CHECK-DAG: parameter 'h' relation > {{.*}} at [[#@LINE+1]]:9
  if (V > Of.get_parameters(Asked)[0].as_double())
    Out.publish(Number());
  if (Asked.size() != 1 || Asked[0].empty())
    Of.now();
}
