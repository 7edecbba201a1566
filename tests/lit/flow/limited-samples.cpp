// RUN: %compile -O2 %s -o %t.2.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.2.o | FileCheck %s
// RUN: %compile -O0 %s -o %t.0.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.0.o | FileCheck %s
//
// Measured values that a parameter limits are data once they are in an array
// or a list: what is compared with them is not compared with the parameter. An
// array of parameters alone holds thresholds.
#include <ros/ros.h>

#include <algorithm>

double speed(int Axis);

struct Sampler {
  double Most, Least;
  double Reached[3], Limits[3];

  void sample() {
    for (int N = 0; N < 3; ++N) {
      // CHECK: comparisons of {{.*}}: 5
      // CHECK-DAG: 'most' relation < {{.*}} at [[#@LINE+1]]:20
      Reached[N] = std::min(Most, speed(N));
      // CHECK-DAG: 'most' {{.*}} at [[#@LINE+2]]:19
      // CHECK-DAG: 'least' {{.*}} at [[#@LINE+1]]:19
      Limits[N] = std::max(Most, Least);
    }
  }
  bool isLess(int Axis, double Value) const { return Value < Reached[Axis]; }
  bool isPast(int Axis, double Value) const {
    // CHECK-DAG: 'most' {{.*}} at [[#@LINE+2]]:18
    // CHECK-DAG: 'least' {{.*}} at [[#@LINE+1]]:18
    return Value > Limits[Axis];
  }
};

int main() {
  ros::NodeHandle Handle;
  ros::Publisher Out;
  Sampler Own;
  Handle.param("most", Own.Most, 1.0);
  Handle.param("least", Own.Least, 1.0);
  std_msgs::Number Message;
  for (int Axis = 0; Axis < 3; ++Axis) {
    Own.sample();
    Message.data = Own.isLess(Axis, speed(Axis));
    if (Own.isPast(Axis, speed(Axis)))
      Out.publish(Message);
  }
}
