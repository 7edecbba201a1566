// RUN: %native -c %inputs/ros.cpp -DNO_LOG_ONE -o %t.ros.o
// RUN: %compile -O2 %s -o %t.o
// RUN: %link -O2 -Wl,--export-dynamic %t.o %t.ros.o -o %t
// RUN: %t | FileCheck %s
//
// A program's own log_one may compare and publish: it must not be made to call
// itself without end.
#include <ros/ros.h>

#include <cstdio>

double Enough;
ros::Publisher *Reports;

void log_one(char *, bool Result, double Compared, double, bool) {
  std::printf("own %d\n", Result);
  if (Compared > Enough)
    Reports->publish(std_msgs::Number());
}

int main(int Argc, char **) {
  ros::NodeHandle Handle;
  ros::Publisher Out = Handle.advertise<std_msgs::Number>("out", 1);
  Reports = &Out;
  double Limit;
  Handle.param("limit", Limit, 0.0);
  Handle.param("enough", Enough, 0.0);
  // CHECK: own 1
  // CHECK-NEXT: published
  // CHECK-NEXT: published
  // CHECK-NOT: own
  if (Argc > Limit)
    Out.publish(std_msgs::Number());
}
