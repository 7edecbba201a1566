// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
// RUN: %compile -O0 %s -o %t.0.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.0.o | FileCheck %s
//
// The functions that callbacks hand a parameter to: its name is the one that
// the caller was called back for, or has tested.
#include <rclcpp/rclcpp.hpp>

using Number = std_msgs::msg::Number;

// CHECK-DAG: comparisons of {{.*}}: 5
class Node : public rclcpp::Node {
public:
  Node() : rclcpp::Node("node"), Events(this) {
    First = Events.add_parameter_callback(
        "a", std::bind(&Node::take, this, std::placeholders::_1));
    Second = Events.add_parameter_callback(
        "b", [this](const rclcpp::Parameter &P) { take(P); });
    Set = add_on_set_parameters_callback(
        [this](const std::vector<rclcpp::Parameter> &All) { return set(All); });
  }
  void take(const rclcpp::Parameter &P) { A = P.as_double(); }
  rcl_interfaces::msg::SetParametersResult
  set(const std::vector<rclcpp::Parameter> &All) {
    for (const rclcpp::Parameter &P : All)
      if (P.get_name() == "c")
        takeTested(P);
      else
        takeOther(P);
    rcl_interfaces::msg::SetParametersResult Result;
    Result.successful = true;
    return Result;
  }
  void takeTested(const rclcpp::Parameter &P) { keep(P); }
  void keep(const rclcpp::Parameter &P) { C = P.as_double(); }
  void takeOther(const rclcpp::Parameter &P) { D = P.as_double(); }
  void takeBoth(const rclcpp::Parameter &P) { E = P.as_double(); }
  void takeOne() { takeBoth(get_parameter("e")); }
  void step(double V) {
    // CHECK-DAG: parameter 'a' relation > {{.*}} at [[#@LINE+2]]:11
    // CHECK-DAG: parameter 'b' relation > {{.*}} at [[#@LINE+1]]:11
    if (V > A)
      Out.publish(Number());
    // CHECK-DAG: parameter 'c' relation > {{.*}} at [[#@LINE+1]]:11
    if (V > C)
      Out.publish(Number());
    // CHECK-DAG: parameter '<dynamic>' relation > {{.*}} at [[#@LINE+1]]:11
    if (V > D)
      Out.publish(Number());
    // CHECK-DAG: parameter 'e' relation > {{.*}} at [[#@LINE+1]]:11
    if (V > E)
      Out.publish(Number());
  }

private:
  std::shared_ptr<void> First, Second, Set;
  rclcpp::ParameterEventHandler Events;
  rclcpp::Publisher<Number> Out;
  double A = 0, C = 0, D = 0, E = 0;
};

void run(double V) {
  Node N;
  N.takeOne();
  N.step(V);
}
