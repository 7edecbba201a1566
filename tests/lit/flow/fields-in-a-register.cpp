// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// A struct that is returned and handed over in registers: two numbers in one of
// 64 bits, or three in a pair. Each number is followed, and no other is taken
// for it.
#include <ros/ros.h>

struct Rate {
  int Keep = 1, Drop = 2, Never = 3;
};
struct Pair {
  int First, Second;
};

static Pair readPair(ros::NodeHandle &Handle) {
  Pair P;
  Handle.getParam("first", P.First);
  Handle.getParam("second", P.Second);
  return P;
}

static Rate readRate(ros::NodeHandle &Handle) {
  Rate R;
  Handle.getParam("keep", R.Keep);
  Handle.getParam("drop", R.Drop);
  Handle.getParam("never", R.Never);
  return R;
}

class Filter {
public:
  Filter(Pair P, Rate R) : P(P), R(R) {}
  void step(ros::Publisher &Out, int N) {
    // CHECK: comparisons of {{.*}}: 3
    // CHECK-DAG: parameter 'second' relation > as x {{.*}} at [[#@LINE+1]]:11
    if (N > P.Second)
      Out.publish(std_msgs::Number());
    // CHECK-DAG: parameter 'drop' relation < as x {{.*}} at [[#@LINE+1]]:11
    if (N < R.Drop)
      Out.publish(std_msgs::Number());
    // CHECK-DAG: parameter 'keep' relation == as x {{.*}} at [[#@LINE+1]]:11
    if (N == R.Keep)
      Out.publish(std_msgs::Number());
  }

private:
  Pair P;
  Rate R;
};

void run(ros::NodeHandle &Handle, ros::Publisher &Out, int N) {
  Filter F(readPair(Handle), readRate(Handle));
  F.step(Out, N);
}
