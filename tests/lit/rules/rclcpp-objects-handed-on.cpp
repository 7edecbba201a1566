// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
// RUN: %compile -O0 %s -o %t.0.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.0.o | FileCheck %s
//
// Objects that are handed on: a function that only reads an object assigns
// nothing to it, and one that gets two objects does not copy one to the other.
// A function may return an object, a lambda may assign to one, and an object
// may be at the beginning of another.
#include <rclcpp/rclcpp.hpp>

using Number = std_msgs::msg::Number;

void show(const rclcpp::Parameter &P);

struct Limits {
  rclcpp::Parameter Low, High;
  bool isValid(const rclcpp::Parameter &P) const;
};

// CHECK-DAG: comparisons of {{.*}}: 9{{$}}
class Node : public rclcpp::Node {
public:
  Node() : rclcpp::Node("node") {
    rclcpp::Parameter P = get_parameter("a");
    if (!Held.isValid(P))
      return;
    Held.Low = get_parameter("low");
    Held.High = get_parameter("high");
  }
  rclcpp::Parameter other() const { return get_parameter("h"); }
  void step(double V) {
    // CHECK-DAG: parameter 'low' relation < {{.*}} at [[#@LINE+1]]:11
    if (V < Held.Low.as_double())
      Out.publish(Number());
    // CHECK-DAG: parameter 'high' relation > {{.*}} at [[#@LINE+1]]:11
    if (V > Held.High.as_double())
      Out.publish(Number());
    rclcpp::Parameter P = get_parameter("b");
    // CHECK-DAG: parameter 'b' relation > {{.*}} at [[#@LINE+1]]:11
    if (V > P.as_double())
      Out.publish(Number());
    P = get_parameter("c");
    show(P);
    // CHECK-DAG: parameter 'c' relation > {{.*}} at [[#@LINE+1]]:11
    if (V > P.as_double())
      Out.publish(Number());
    rclcpp::Parameter Q = get_parameter("d");
    auto Set = [&] { Q = get_parameter("e"); };
    if (V > 3)
      Set();
    // CHECK-DAG: parameter 'd' relation > {{.*}} at [[#@LINE+2]]:11
    // CHECK-DAG: parameter 'e' relation > {{.*}} at [[#@LINE+1]]:11
    if (V > Q.as_double())
      Out.publish(Number());
    rclcpp::Parameter R = get_parameter("f");
    if (V > 7)
      R = other();
    else
      show(R);
    // CHECK-DAG: parameter 'f' relation > {{.*}} at [[#@LINE+2]]:11
    // CHECK-DAG: parameter 'h' relation > {{.*}} at [[#@LINE+1]]:11
    if (V > R.as_double())
      Out.publish(Number());
    rclcpp::Parameter S;
    S = other();
    // CHECK-DAG: parameter 'h' relation > {{.*}} at [[#@LINE+1]]:11
    if (V > S.as_double())
      Out.publish(Number());
  }

private:
  Limits Held;
  rclcpp::Publisher<Number> Out;
};

void run(double V) { Node().step(V); }
