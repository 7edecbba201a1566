// RUN: %compile -O2 %s -o %t.2.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.2.o | FileCheck %s
// RUN: %compile -O0 %s -o %t.0.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.0.o | FileCheck %s
//
// To log a message calls nothing of the program, whatever the message gets: a
// member that was overwritten before is not the parameter. Another library may
// call what it gets, so the member may be the parameter again.
#include <ros/ros.h>

struct Filter {
  virtual ~Filter();
  virtual bool isEnabled();
};
namespace ros::console {
void print(Filter *Of, const char *Message);
}
void process(Filter *Of);

struct Grid : Filter {
  ros::Publisher Out;
  double Size = 0;
  void logged(double V, double New) {
    Size = New;
    ros::console::print(this, "new size");
    if (V > Size)
      Out.publish(std_msgs::Number());
  }
  void handed(double V, double New) {
    Size = New;
    process(this);
    // CHECK: comparisons of {{.*}}: 1
    // CHECK-NEXT: parameter 'size' {{.*}} at [[#@LINE+1]]:11
    if (V > Size)
      Out.publish(std_msgs::Number());
  }
  bool isEnabled() override {
    ros::NodeHandle Handle;
    return Handle.getParam("size", Size);
  }
};

int main(int Argc, char **) {
  Grid G;
  G.logged(Argc, 1);
  G.handed(Argc, 2);
}
