// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-param-calls>,print<tpc-gather-results>' %t.o | FileCheck %s
// RUN: %compile -O0 %s -o %t.0.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-param-calls>,print<tpc-gather-results>' %t.0.o | FileCheck %s
//
// The ways in which a ROS 2 node reads a parameter: as a value, into a
// variable, and as an object with a method that returns the value.
#include <rclcpp/rclcpp.hpp>

// CHECK-DAG: parameter reads of {{.*}}: 12
// CHECK-DAG: comparisons of {{.*}}: 11
class Node : public rclcpp::Node {
public:
  Node() : rclcpp::Node("node") {
    // CHECK-DAG: declare_parameter 'a' double default 1.5 in
    A = declare_parameter<double>("a", 1.5);
    // CHECK-DAG: declare_parameter 'b' double default null in
    B = declare_parameter<double>("b");
    // CHECK-DAG: get_parameter 'c' double default null in
    get_parameter("c", C);
    // CHECK-DAG: get_parameter_or 'd' long default 7 in
    get_parameter_or<int64_t>("d", D, 7);
    // CHECK-DAG: declare_parameter 'e' default 2.5 in
    declare_parameter("e", rclcpp::ParameterValue(2.5));
    // CHECK-DAG: get_parameter 'e' double default null in
    E = get_parameter("e").as_double();
    // CHECK-DAG: get_parameter 'f' bool default null in
    F = get_parameter("f").get_value<bool>();
    // CHECK-DAG: declare_parameter 'g' double default 3.5 in
    G = declare_parameter("g", rclcpp::ParameterValue(3.5)).get<double>();
    // CHECK-DAG: get_parameter 'h' long default null in
    rclcpp::Parameter Object;
    if (get_parameter("h", Object))
      H = Object.as_int();
    // CHECK-DAG: get_parameter 'i' double default null in
    Kept = get_parameter("i");
    Out = create_publisher<std_msgs::msg::Number>("out", 1);
  }
  void changed(const rclcpp::Parameter &New) {
    // CHECK-DAG: rclcpp::Parameter::as_double 'j' double default null in
    if (New.get_name() == "j")
      J = New.as_double();
    // CHECK-DAG: get_parameter 'k' double default null in
    K = get_parameter("k").get_parameter_value().get<double>();
  }
  void step(double V, int64_t N) {
    std_msgs::msg::Number M;
    // CHECK-DAG: parameter 'a' relation > {{.*}} at [[#@LINE+1]]:11
    if (V > A)
      Out->publish(M);
    // CHECK-DAG: parameter 'b' relation > {{.*}} at [[#@LINE+1]]:11
    if (V > B)
      Out->publish(M);
    // CHECK-DAG: parameter 'c' relation > {{.*}} at [[#@LINE+1]]:11
    if (V > C)
      Out->publish(M);
    // CHECK-DAG: parameter 'd' relation > {{.*}} at [[#@LINE+1]]:11
    if (N > D)
      Out->publish(M);
    // CHECK-DAG: parameter 'e' relation > {{.*}} at [[#@LINE+1]]:11
    if (V > E)
      Out->publish(M);
    // CHECK-DAG: flag 'f' relation flag {{.*}} at [[#@LINE+1]]:9
    if (F)
      Out->publish(M);
    // CHECK-DAG: parameter 'g' relation > {{.*}} at [[#@LINE+1]]:11
    if (V > G)
      Out->publish(M);
    // CHECK-DAG: parameter 'h' relation > {{.*}} at [[#@LINE+1]]:11
    if (N > H)
      Out->publish(M);
    // CHECK-DAG: parameter 'i' relation > {{.*}} at [[#@LINE+1]]:11
    if (V > Kept.as_double())
      Out->publish(M);
    // CHECK-DAG: parameter 'j' relation > {{.*}} at [[#@LINE+1]]:11
    if (V > J)
      Out->publish(M);
    // CHECK-DAG: parameter 'k' relation > {{.*}} at [[#@LINE+1]]:11
    if (V > K)
      Out->publish(M);
  }

private:
  std::shared_ptr<rclcpp::Publisher<std_msgs::msg::Number>> Out;
  rclcpp::Parameter Kept;
  double A, B, C, E, G, J, K;
  int64_t D, H;
  bool F;
};

void run(double V) {
  Node N;
  N.changed(rclcpp::Parameter());
  N.step(V, 3);
}
