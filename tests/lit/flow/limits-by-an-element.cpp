// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
// RUN: %compile -O0 %s -o %t.0.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.0.o | FileCheck %s
//
// An element of a parameter that limits a measured variable is compared with it
// there, and not where the variable is compared later.
#include <algorithm>
#include <cmath>
#include <rclcpp/rclcpp.hpp>

using Number = std_msgs::msg::Number;

class Node : public rclcpp::Node {
public:
  Node() : rclcpp::Node("node") {
    Most = get_parameter("most").as_double_array();
    Dead = declare_parameter("dead", 0.1);
    Out = create_publisher<Number>("out", 1);
  }
  // CHECK: comparisons of {{.*}}: 2
  void step(double Sensed) {
    Speed = Sensed;
    // CHECK-DAG: derived 'most' relation {{.*}} as x[] {{.*}} at [[#@LINE+1]]:13
    Speed = std::min(Speed, Most[0]);
    // CHECK-DAG: parameter 'dead' relation < as x {{.*}} at [[#@LINE+1]]:26
    if (std::fabs(Speed) < Dead)
      Speed = 0;
    Number Sent;
    Sent.data = Speed;
    Out->publish(Sent);
  }

private:
  std::shared_ptr<rclcpp::Publisher<Number>> Out;
  std::vector<double> Most;
  double Dead, Speed = 0;
};

void run(double Sensed) { Node().step(Sensed); }
