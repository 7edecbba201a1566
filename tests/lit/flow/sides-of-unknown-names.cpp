// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// Two parameters whose names depend on the call are not taken for one: both
// sides are reported, although one is farther from its read.
#include <ros/ros.h>

struct Node {
  ros::NodeHandle Handle;
  ros::Publisher Out;
  double Low;

  void step(const std::string &A, const std::string &B) {
    double High;
    Handle.getParam(A, Low);
    Handle.getParam(B, High);
    double Twice = High * 2;
    // CHECK-DAG: parameter '<dynamic>' relation < as x {{.*}} at [[#@LINE+2]]:13
    // CHECK-DAG: derived '<dynamic>' relation > as 2 * x {{.*}} at [[#@LINE+1]]:13
    if (Low > Twice)
      Out.publish(std_msgs::Number());
  }
};

void run(Node &N, std::string *Names) { N.step(Names[0], Names[1]); }
