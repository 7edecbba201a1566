// RUN: %native -c %inputs/ros.cpp -o %t.ros.o
// RUN: %compile -O0 %s -o %t.0.o
// RUN: %link -O0 %t.0.o %t.ros.o -o %t.0
// RUN: %t.0 | FileCheck %s
// RUN: %compile -O2 %s -o %t.2.o
// RUN: %link -O2 %t.2.o %t.ros.o -o %t.2
// RUN: %t.2 | FileCheck %s
//
// Unsigned numbers are reported as such, whatever the operator.
#include <ros/ros.h>

#include <cstdint>

struct Node {
  uint32_t Wide;
  uint8_t Byte;
  int Signed;
};

int main(int Argc, char **) {
  ros::NodeHandle Handle;
  ros::Publisher Out = Handle.advertise<std_msgs::Number>("out", 1);
  int N;
  Handle.param("n", N, -1);
  Node Own;
  Own.Wide = N;
  Own.Byte = N;
  uint32_t Most = 0xffffffffu - (Argc - 1);
  // CHECK: report 1 cmp 1 thresh 4294967295 res 1
  if (static_cast<uint32_t>(Argc) < Own.Wide)
    Out.publish(std_msgs::Number());
  // CHECK: report 1 cmp 255 thresh 255 res 1
  if (static_cast<uint8_t>(Most) == Own.Byte)
    Out.publish(std_msgs::Number());
  // CHECK: report 0 cmp 1 thresh -1 res 0
  if (Argc < N)
    Out.publish(std_msgs::Number());
}
