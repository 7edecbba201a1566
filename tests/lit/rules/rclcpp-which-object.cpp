// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-param-calls>,print<tpc-gather-results>' %t.o | FileCheck %s
// RUN: %compile -O0 %s -o %t.0.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-param-calls>,print<tpc-gather-results>' %t.0.o | FileCheck %s
//
// Which parameter an object holds: the last assignment of a local variable, the
// test of its name, or the name that its callback was registered for.
#include <rclcpp/rclcpp.hpp>

class Node : public rclcpp::Node {
public:
  Node() : rclcpp::Node("node"), Events(this) {
    rclcpp::Parameter P;
    P = get_parameter("a");
    A = P.as_double();
    P = get_parameter("b");
    B = P.get_value<double>();
    Prefix = "c";
    Set = add_on_set_parameters_callback(
        [this](const std::vector<rclcpp::Parameter> &All) { return set(All); });
    Event = Events.add_parameter_callback(
        "f", [this](const rclcpp::Parameter &P) { F = P.as_double(); });
    Out = create_publisher<std_msgs::msg::Number>("out", 1);
  }
  // CHECK-DAG: parameter reads of {{.*}}: 6
  // CHECK-DAG: Parameter::as_double 'c.d' double
  // CHECK-DAG: Parameter::as_double 'e' double
  // CHECK-DAG: Parameter::as_double '<dynamic>' double
  // CHECK-DAG: Parameter::as_double 'f' double
  // CHECK-DAG: comparisons of {{.*}}: 7
  rcl_interfaces::msg::SetParametersResult
  set(const std::vector<rclcpp::Parameter> &All) {
    rcl_interfaces::msg::SetParametersResult Result;
    Result.successful = true;
    for (const rclcpp::Parameter &P : All) {
      const std::string &Name = P.get_name();
      if (Name == Prefix + ".d") {
        D = P.as_double();
      } else if (Name != "e") {
        G = P.as_double();
      } else {
        E = P.as_double();
        // What the callback returns decides whether the value is taken.
        // CHECK-DAG: parameter 'e' relation > as x distance {{.*}} at [[#@LINE+1]]:15
        if (E < 0.5)
          Result.successful = false;
      }
    }
    return Result;
  }
  void step(double V) {
    std_msgs::msg::Number M;
    // CHECK-DAG: parameter 'a' relation > {{.*}} at [[#@LINE+1]]:11
    if (V > A)
      Out->publish(M);
    // CHECK-DAG: parameter 'b' relation > {{.*}} at [[#@LINE+1]]:11
    if (V > B)
      Out->publish(M);
    // CHECK-DAG: parameter 'c.d' relation > {{.*}} at [[#@LINE+1]]:11
    if (V > D)
      Out->publish(M);
    // CHECK-DAG: parameter 'e' relation > {{.*}} at [[#@LINE+1]]:11
    if (V > E)
      Out->publish(M);
    // CHECK-DAG: parameter 'f' relation > {{.*}} at [[#@LINE+1]]:11
    if (V > F)
      Out->publish(M);
    // CHECK-DAG: parameter '<dynamic>' relation > {{.*}} at [[#@LINE+1]]:11
    if (V > G)
      Out->publish(M);
  }

private:
  std::shared_ptr<rclcpp::Publisher<std_msgs::msg::Number>> Out;
  std::shared_ptr<void> Set, Event;
  rclcpp::ParameterEventHandler Events;
  std::string Prefix;
  double A, B, D = 0, E = 0, F = 0, G = 0;
};

void run(double V) { Node().step(V); }
