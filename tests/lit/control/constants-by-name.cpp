// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// A const member to which all constructors give the same value, and what a
// function always returns, are constants. A member that is not const, a function
// with two results, and a member that the constructor gets as an argument are not.
#include <ros/ros.h>

static double band() { return 0.75; }
static double either(bool B) { return B ? 0.5 : 0.25; }

class Node {
public:
  explicit Node(double Handed) : Given(Handed) {}
  void step(ros::Publisher &Out, double V, bool B) {
    // CHECK-LABEL: comparisons with constants: 2
    // CHECK-DAG: constant 'Slope' relation > as x distance 1 {{.*}} at [[#@LINE+1]]:11
    if (V > Slope)
      Out.publish(std_msgs::Number());
    // CHECK-DAG: constant 'band()' relation < as x distance 1 {{.*}} at [[#@LINE+1]]:11
    if (V < band())
      Out.publish(std_msgs::Number());
    if (V > State)
      Out.publish(std_msgs::Number());
    if (V > Given)
      Out.publish(std_msgs::Number());
    if (V > either(B))
      Out.publish(std_msgs::Number());
  }

private:
  const double Slope = 1.25;
  const double Given;
  double State = 3.5;
};

void run(ros::Publisher &Out, double V, bool B) {
  Node N(V);
  N.step(Out, V, B);
}
