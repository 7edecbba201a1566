// RUN: %native -c %inputs/ros.cpp -o %t.ros.o
// RUN: %compile -O0 %s -o %t.0.o
// RUN: %link -O0 %t.0.o %t.ros.o -o %t.0
// RUN: %t.0 | FileCheck %s
// RUN: %compile -O2 %s -o %t.2.o
// RUN: %link -O2 %t.2.o %t.ros.o -o %t.2
// RUN: %t.2 | FileCheck %s
//
// A function that compares members of the objects that it gets reports in each
// call under the parameter that this call's object holds.
#include <ros/ros.h>

struct Level {
  double Value = 0;
  // Both calls below run this one comparison: high 100 < 10, then 10 < low 1.
  // CHECK: report 0 cmp 10 thresh 100 res 0 key [[HIGH:....]]
  // CHECK-NEXT: report 0 cmp 10 thresh 1 res 0 key [[LOW:....]]
  bool operator<(const Level &Other) const { return Value < Other.Value; }
};

struct Switch {
  bool On = false;
  // CHECK-NEXT: report 1 {{.*}} key [[ON:....]]
  // CHECK-NEXT: published out 0
  // CHECK-NEXT: report 0 {{.*}} key [[OFF:....]]
  void use(ros::Publisher &Out) const {
    if (On)
      Out.publish(std_msgs::Number());
  }
};

struct Node {
  Level High, Low;
  Switch First, Second;
  void read(ros::NodeHandle &Handle) {
    Handle.param("high", High.Value, 100.0);
    Handle.param("low", Low.Value, 1.0);
    Handle.param("first", First.On, true);
    Handle.param("second", Second.On, false);
  }
  void step(ros::Publisher &Out, double Value) {
    const Level Now{Value};
    if (High < Now)
      Out.publish(std_msgs::Number());
    if (Now < Low)
      Out.publish(std_msgs::Number());
    First.use(Out);
    Second.use(Out);
  }
};
// CHECK-NOT: {{.}}

int main(int Argc, char **) {
  ros::NodeHandle Handle;
  ros::Publisher Out = Handle.advertise<std_msgs::Number>("out", 1);
  Node Own;
  Own.read(Handle);
  Own.step(Out, 10 * Argc);
}
