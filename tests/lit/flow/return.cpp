// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// A getter, by value and by reference.
#include <ros/ros.h>

class Settings {
public:
  explicit Settings(ros::NodeHandle &Handle) {
    Handle.param("near", Near, 0.5);
    Handle.param("far", Far, 5.0);
  }
  double near() const { return Near; }
  const double &far() const { return Far; }

private:
  double Near, Far;
};

void step(const Settings &S, ros::Publisher &Out, double Value) {
  // CHECK: comparisons of {{.*}}: 2
  // CHECK: parameter 'near' {{.*}} at [[#@LINE+1]]:13
  if (Value > S.near())
    Out.publish(std_msgs::Number());
  // CHECK: parameter 'far' {{.*}} at [[#@LINE+1]]:13
  if (Value > S.far())
    Out.publish(std_msgs::Number());
}

void run(ros::NodeHandle &Handle, ros::Publisher &Out) {
  Settings S(Handle);
  step(S, Out, 1);
}
