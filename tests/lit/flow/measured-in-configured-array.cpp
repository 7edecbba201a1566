// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// An array with one configured element that a function has filled since then
// holds measured values: what it is compared with is the threshold and the
// array is not, whichever element is used.
#include <ros/ros.h>

void fill(double *);

class Node {
public:
  explicit Node(ros::NodeHandle &Handle) {
    Handle.param("limit", Limit, 5.0);
    Handle.param("gain", Gain, 1.0);
  }
  void step(ros::Publisher &Out, int Place) {
    Readings[Place] = Gain;
    fill(Readings);
    // CHECK: comparisons of {{.*}}: 1
    // CHECK-NEXT: parameter 'limit' relation > as x {{.*}} at [[#@LINE+1]]:25
    if (Readings[Place] > Limit)
      Out.publish(std_msgs::Number());
  }

private:
  double Limit, Gain;
  double Readings[4] = {};
};

void run(ros::NodeHandle &Handle, ros::Publisher &Out, int Place) {
  Node N(Handle);
  N.step(Out, Place);
}
