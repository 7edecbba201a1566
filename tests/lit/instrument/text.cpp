// RUN: %native -c %inputs/ros.cpp -o %t.ros.o
// RUN: %compile -O0 %s -o %t.0.o
// RUN: %link -O0 %t.0.o %t.ros.o -o %t.0
// RUN: %t.0 | FileCheck %s
// RUN: %compile -O2 %s -o %t.2.o
// RUN: %link -O2 %t.2.o %t.ros.o -o %t.2
// RUN: %t.2 | FileCheck %s
//
// Comparisons of text report only their result, as both values.
#include <ros/ros.h>

static __attribute__((noinline)) bool is(const std::string &Text,
                                         const char *Wanted) {
  return Text == Wanted;
}

int main(int Argc, char **) {
  ros::NodeHandle Handle;
  ros::Publisher Out = Handle.advertise<std_msgs::Number>("out", 1);
  std::string Mode, Other;
  Handle.param("mode", Mode, std::string("fast"));
  Handle.param("other", Other, std::string("slow"));
  // CHECK: report 1 cmp 1 thresh 1 res 1 key [[MODE:....]]
  if (Mode == "fast")
    Out.publish(std_msgs::Number());
  // CHECK-NEXT: published
  // CHECK-NEXT: report 0 cmp 0 thresh 0 res 0
  if (Mode != "fast")
    Out.publish(std_msgs::Number());
  // CHECK-NEXT: report 1 cmp 1 thresh 1 res 1
  if (!(Mode.compare("fast") == 0))
    Out.publish(std_msgs::Number());
  // CHECK-NEXT: report 1 cmp 1 thresh 1 res 1 key [[IS:....]]
  if (is(Mode, "fast"))
    Out.publish(std_msgs::Number());
  // CHECK-NEXT: published
  // CHECK-NOT: key [[IS]]
  // CHECK: report 0 cmp 0 thresh 0 res 0
  if (is(Other, "fast"))
    Out.publish(std_msgs::Number());
}
