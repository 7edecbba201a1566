// RUN: %native -c %inputs/ros.cpp -o %t.ros.o
// RUN: %compile -O2 %s -o %t.o
// RUN: %link -O2 -Wl,-mllvm,-tpc-static-info=%t.json %t.o %t.ros.o -o %t
// RUN: %t | FileCheck %s
// RUN: FileCheck %s --check-prefix=JSON --input-file=%t.json
//
// Two comparisons that a macro puts at one place have different keys.
#include <ros/ros.h>

#define NEAR(V, L) ((V) < (L) && (V) > -(L))

// JSON: "comparisons": 2,
int main(int Argc, char **) {
  ros::NodeHandle Handle;
  double Limit;
  Handle.param("limit", Limit, 2.0);
  ros::Publisher Out = Handle.advertise<std_msgs::Number>("out", 1);
  // CHECK: report 1 cmp 1 thresh 2 res 1 key [[FIRST:....]]
  // CHECK-NOT: key [[FIRST]]
  // CHECK: report 1 cmp 1 thresh -2 res 1
  if (NEAR(static_cast<double>(Argc), Limit))
    Out.publish(std_msgs::Number());
}
