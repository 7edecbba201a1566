// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// Putting an object into a container does not change the object, so what
// controls that does not decide what is published; what swap takes over from a
// container does.
#include <ros/ros.h>

#include <vector>

struct Batch {
  double data;
  std::vector<double> Numbers;
};

void step(ros::NodeHandle &Handle, ros::Publisher &Out, double V,
          const std_msgs::Number &Message) {
  double Kept, Swapped;
  Handle.param("kept", Kept, 1.0);
  Handle.param("swapped", Swapped, 1.0);
  // CHECK: comparisons of {{.*}}: 1
  // CHECK: parameter 'swapped' {{.*}} at [[#@LINE+7]]:9
  std::vector<std_msgs::Number> Dropped;
  if (V > Kept)
    Dropped.push_back(Message);
  Out.publish(Message);
  Batch Mine;
  std::vector<double> Other{1, 2};
  if (V > Swapped)
    Other.swap(Mine.Numbers);
  Out.publish(Mine);
}
