// RUN: %compile -O2 %s -o %t.o
// RUN: llvm-link %t.o -o %t.bc
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.bc | FileCheck %s
//
// What bind objects, lambdas and functors store: each class has its own
// numbers, whatever else is bound, although the linker merges all classes that
// contain a double (which is why the test links). A bound number that nobody
// compares is not found.
#include <functional>
#include <ros/ros.h>

struct Cap {
  double Most;
  bool operator()(double V) const {
    // CHECK: comparisons of {{.*}}: 5
    // CHECK-DAG: parameter 'cap' relation > as x {{.*}} at [[#@LINE+1]]:14
    return V > Most;
  }
};

static bool between(double Low, double High, double V) {
  // CHECK-DAG: parameter 'low' relation > as x {{.*}} at [[#@LINE+2]]:12
  // CHECK-DAG: parameter 'high' relation < as x {{.*}} at [[#@LINE+1]]:23
  return V > Low && V < High;
}

static bool above(double Floor, float Unused, double V) {
  // CHECK-DAG: parameter 'floor' relation >= as x {{.*}} at [[#@LINE+1]]:12
  return V >= Floor;
}

void step(ros::Publisher &Out, const std::function<bool(double)> &F, double V) {
  if (F(V))
    Out.publish(std_msgs::Number());
}

void run(ros::NodeHandle &Handle, ros::Publisher &Out, double V) {
  double Low, High, Floor, Upper, Most;
  float Unused;
  Handle.param("low", Low, 0.5);
  Handle.param("high", High, 1.5);
  Handle.param("floor", Floor, 0.5);
  Handle.param("unused", Unused, 0.5F);
  Handle.param("upper", Upper, 0.5);
  Handle.param("cap", Most, 0.5);
  using std::placeholders::_1;
  step(Out, std::bind(between, Low, High, _1), V);
  step(Out, std::bind(above, Floor, Unused, _1), V);
  // CHECK-DAG: parameter 'upper' relation < as x {{.*}} at [[#@LINE+1]]:42
  step(Out, [Upper](double X) { return X < Upper; }, V);
  step(Out, Cap{Most}, V);
}
