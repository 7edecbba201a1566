// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// What owners of objects call to end their life writes nothing that is
// published, also where it is a virtual destructor that is not known.
#include <ros/ros.h>

#include <memory>

struct Box : std_msgs::Number {
  virtual ~Box();
  virtual void fill();
};

static double Limit, Level;
static Box Kept;

// CHECK: comparisons of {{.*}}: 1
// CHECK-NEXT: 'level' {{.*}} at [[#@LINE+5]]:9
// CHECK-NEXT: comparisons with constants
void input(double V) {
  if (V > Limit)
    std::default_delete<Box>()(&Kept);
  if (V > Level)
    Kept.fill();
}

void run(ros::NodeHandle &Handle, ros::Publisher &Out, double V) {
  Handle.param("limit", Limit, 1.0);
  Handle.param("level", Level, 1.0);
  input(V);
  Out.publish(Kept);
}
