// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// Destroying an object writes nothing that is published: neither its destructor,
// which is in another link unit, nor the function that frees the memory.
#include <ros/ros.h>

struct Box : std_msgs::Number {
  ~Box();
  void fill();
};

static double Limit, Level;
static Box Kept;

// CHECK: comparisons of {{.*}}: 1
// CHECK-NEXT: 'level' {{.*}} at [[#@LINE+7]]:9
// CHECK-NEXT: comparisons with constants
void input(double V) {
  if (V > Limit)
    delete &Kept;
  if (V < Limit)
    Kept.~Box();
  if (V > Level)
    Kept.fill();
}

void run(ros::NodeHandle &Handle, ros::Publisher &Out, double V) {
  Handle.param("limit", Limit, 1.0);
  Handle.param("level", Level, 1.0);
  input(V);
  Out.publish(Kept);
}
