// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// A destructor that publishes runs when the last owner releases the object:
// what controls the release decides, the count of the other owners does not.
#include <ros/ros.h>

#include <memory>

struct Thing {
  ros::Publisher Out;
  ~Thing() { Out.publish(std_msgs::Number()); }
};

static double Limit, Level;
static std::shared_ptr<Thing> Kept;

void share(std::shared_ptr<Thing> &Of);

// CHECK: comparisons of {{.*}}: 1
// CHECK-NEXT: 'level' {{.*}} at [[#@LINE+5]]:9
// CHECK-NEXT: comparisons with constants
void input(double V) {
  if (V > Limit)
    share(Kept);
  if (V > Level)
    Kept.reset();
}

void run(ros::NodeHandle &Handle, double V) {
  Handle.param("limit", Limit, 1.0);
  Handle.param("level", Level, 1.0);
  Kept = std::make_shared<Thing>();
  input(V);
}
