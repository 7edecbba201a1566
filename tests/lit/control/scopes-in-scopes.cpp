// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// When nested scopes with cleanups are left, the compiler checks several times
// where to continue: a check that leads to a return on both paths decides
// nothing of the code behind.
#include <ros/ros.h>

void used(const std::string &Text);

// CHECK: comparisons of {{.*}}: 1
// CHECK-NEXT: parameter 'left' relation > as x distance 1
void run(ros::NodeHandle &Handle, ros::Publisher &Out, double Value) {
  double Left = 0, Counted = 0;
  Handle.getParam("left", Left);
  Handle.getParam("counted", Counted);
  try {
    used("");
  } catch (int) {
    std::string Outer("outer");
    {
      std::string Inner("inner");
      if (Value > Left) {
        if (Value > Counted) {
          used(Inner);
          return;
        }
        return;
      }
    }
  }
  Out.publish(std_msgs::Number());
}
