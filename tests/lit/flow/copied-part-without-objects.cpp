// RUN: %compile -O2 %s -o %t.2.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.2.o | FileCheck %s
// RUN: %compile -O0 %s -o %t.0.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.0.o | FileCheck %s
//
// Null, and the pointer to a class's virtual functions, lead to no object: a
// local that holds only these stays apart from others of its class, even if a
// part of it is copied.
#include <ros/ros.h>

struct Limits {
  double Most, Least, Step;
};

struct Guard {
  int *Owner = nullptr;
  virtual void reset() {}
  Limits Used;
};

ros::Publisher Out;
Guard *Elsewhere;

__attribute__((noinline)) void check(const Guard &By, double Here) {
  Limits Copy = By.Used;
  // CHECK: comparisons of {{.*}}: 1
  // CHECK-NEXT: parameter 'most' relation < {{.*}} at [[#@LINE+1]]:12
  if (Here < Copy.Most)
    Out.publish(std_msgs::Number());
}

int main(int Argc, char **) {
  ros::NodeHandle Handle;
  Guard Own;
  Handle.param("most", Own.Used.Most, 4.0);
  check(Own, 1);
  Elsewhere = new Guard;
  Elsewhere->Used.Most = 3;
  if (Argc < Elsewhere->Used.Most)
    Out.publish(std_msgs::Number());
}
