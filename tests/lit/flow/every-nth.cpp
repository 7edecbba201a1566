// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// A counter is divided by a parameter, and the remainder is compared for
// equality: the parameter says how often something is done. Other formulas that
// are compared with a constant have no threshold: the sign of a remainder does
// not depend on the parameter.
#include <cmath>
#include <ros/ros.h>

static double Every, Gain, Turn;

// CHECK: comparisons of {{.*}}: 1
void run(ros::NodeHandle &Handle, ros::Publisher &Out, double Angle) {
  static int Count = 0;
  int Often;
  Handle.getParam("every", Often);
  Handle.param("gain", Gain, 1.0);
  Handle.param("turn", Turn, 6.3);
  // CHECK-NEXT: derived 'every' relation {{[!=]}}= as {{.*}} rem x {{.*}} at [[#@LINE+1]]:
  if (++Count % Often != 0)
    return;
  if (Gain * Count > 3)
    return;
  if (std::fmod(Angle, Turn) < 0)
    return;
  Out.publish(std_msgs::Number());
}
