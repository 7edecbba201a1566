// RUN: %compile -O0 %s -o %t.o
// RUN: %opt -internalize-public-api-list=main -disable-output -passes='internalize,tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
// RUN: %compile -O0 -DLIBRARY %s -o %t.l.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.l.o | FileCheck --check-prefix=LIBRARY %s
//
// All calls of a program pass the same number for a mode: what is behind the
// other modes never runs, and is not reported. If the calls differ, or a number
// is not constant, or if others may call a library, it may run.
#include <ros/ros.h>

enum Kind { Raw, Scaled, Grey };

// CHECK: comparisons of {{.*}}: 3
// LIBRARY: comparisons of {{.*}}: 4
void set(ros::Publisher &Out, double V, double Limit, Kind Of) {
  if (Of == Raw) {
    // LIBRARY-DAG: parameter 'limit' {{.*}} at [[#@LINE+1]]:11
    if (V > Limit)
      Out.publish(std_msgs::Number());
  } else if (V < Limit) { // CHECK-DAG: parameter 'limit' {{.*}} at [[#@LINE]]:16
    Out.publish(std_msgs::Number());
  }
}

void clear(ros::Publisher &Out, double V, double Limit, bool All) {
  // CHECK-DAG: parameter 'limit' {{.*}} at [[#@LINE+1]]:16
  if (All && V >= Limit)
    Out.publish(std_msgs::Number());
}

void draw(ros::Publisher &Out, double V, double Limit, int Level) {
  // CHECK-DAG: parameter 'limit' {{.*}} at [[#@LINE+1]]:22
  if (Level > 2 && V <= Limit)
    Out.publish(std_msgs::Number());
}

#ifdef LIBRARY
void step(int Argc) {
#else
int main(int Argc, char **) {
#endif
  ros::NodeHandle Handle;
  ros::Publisher Out;
  double Limit;
  Handle.param("limit", Limit, 1.0);
  set(Out, Argc, Limit, Scaled);
  set(Out, 2.0 * Argc, Limit, Scaled);
  clear(Out, Argc, Limit, true);
  clear(Out, Argc, Limit, false);
  draw(Out, Argc, Limit, Argc);
}
