// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// A struct that is returned and passed in registers: two numbers in one of 64
// bits, three in a pair, or two floats in a vector. Each number is followed,
// and not confused with another.
#include <ros/ros.h>

struct Rate {
  int Keep = 1, Drop = 2, Never = 3;
};
struct Pair {
  int First, Second;
};

struct Floats {
  float Near, Far;
};

static Floats readFloats(ros::NodeHandle &Handle) {
  Floats F;
  Handle.param("near", F.Near, 0.5F);
  Handle.param("far", F.Far, 1.5F);
  return F;
}

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
    // CHECK: comparisons of {{.*}}: 4
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
  // CHECK-DAG: parameter 'far' relation > as x {{.*}} at [[#@LINE+2]]:9
  Floats Two = readFloats(Handle);
  if (N > Two.Far)
    Out.publish(std_msgs::Number());
  Filter F(readPair(Handle), readRate(Handle));
  F.step(Out, N);
}
