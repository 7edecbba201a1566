// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// A smart pointer that is destroyed leaves null in the object that it was part
// of. Nobody sees that: the object has ended.
#include <ros/ros.h>

#include <memory>

struct Holder {
  std::unique_ptr<std_msgs::Number> Message;
};

static double Limit, Level;
static std::shared_ptr<Holder> Kept;
static Holder *Seen;

// CHECK: comparisons of {{.*}}: 1
// CHECK-NEXT: 'level' {{.*}} at [[#@LINE+5]]:9
// CHECK-NEXT: comparisons with constants
void input(double V) {
  if (V > Limit)
    Kept.reset();
  if (V > Level)
    Seen->Message = std::make_unique<std_msgs::Number>();
}

void run(ros::NodeHandle &Handle, ros::Publisher &Out, double V) {
  Handle.param("limit", Limit, 1.0);
  Handle.param("level", Level, 1.0);
  Kept = std::make_shared<Holder>();
  Seen = Kept.get();
  input(V);
  Out.publish(*Seen->Message);
}
