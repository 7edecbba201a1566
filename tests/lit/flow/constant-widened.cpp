// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes=tpc -tpc-link-unit=node -tpc-static-info=%t.json %t.o
// RUN: FileCheck %s --input-file=%t.json
//
// A constant that is widened before it is compared, and is in a local variable
// that is never written again, causes no failure.
// CHECK: "status": "ok"
#include <ros/ros.h>

void step(ros::Publisher &Out) {
  unsigned char Version = 1;
  if (Version == 3)
    Out.publish(std_msgs::Number());
}
