// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// A small struct is returned in registers. A pointer that a function puts into one
// is the same pointer where it is taken out of it.
#include <ros/ros.h>

struct Place {
  double *Where;
  unsigned long Size;
};

static double Speeds[4], Others[4];

__attribute__((noinline)) static Place placeOf(bool Front, unsigned I) {
  return Front ? Place{&Speeds[I], sizeof(double)} : Place{&Speeds[3 - I], 8};
}
__attribute__((noinline)) static Place otherPlace(unsigned I) { return {&Others[I], 8}; }

void step(ros::NodeHandle &Handle, ros::Publisher &Out, double V, unsigned I) {
  double Limit, Quiet;
  Handle.param("limit", Limit, 1.0);
  Handle.param("quiet", Quiet, 2.0);
  // CHECK: comparisons of {{.*}}: 1
  // CHECK-NEXT: parameter 'limit' {{.*}} at [[#@LINE+1]]:9
  if (V > Limit)
    *placeOf(V > 0, I).Where = V;
  if (V > Quiet)
    *otherPlace(I).Where = V;
  std_msgs::Number Message;
  Message.data = Speeds[2];
  Out.publish(Message);
}
