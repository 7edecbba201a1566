// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// A copy of an object into a local variable and into an argument copies all of
// its fields.
#include <ros/ros.h>

struct Limits {
  double Low, High;
};

class Node {
public:
  explicit Node(ros::NodeHandle &Handle) {
    Handle.param("low", Mine.Low, 1.0);
    Handle.param("high", Mine.High, 1.0);
  }
  // CHECK: comparisons of {{.*}}: 3
  void step(double V) {
    Limits L = Mine;
    // CHECK-DAG: parameter 'high' relation > {{.*}} in _ZN4Node4stepEd at [[#@LINE+1]]:11
    if (V > L.High)
      Out.publish(std_msgs::Number());
    if (inside(V, Mine))
      Out.publish(std_msgs::Number());
  }
  static bool inside(double V, Limits L) {
    // CHECK-DAG: parameter 'low' relation > {{.*}} at [[#@LINE+2]]:14
    // CHECK-DAG: parameter 'high' relation < {{.*}} at [[#@LINE+1]]:27
    return V > L.Low && V < L.High;
  }

private:
  Limits Mine;
  ros::Publisher Out;
};

void run(ros::NodeHandle &Handle) { Node(Handle).step(1); }
