// RUN: %compile -O2 %s -o %t.2.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.2.o | FileCheck %s
// RUN: %compile -O0 %s -o %t.0.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.0.o | FileCheck %s
//
// A local that is only passed to functions, which do not keep its address, is
// none of the objects that unknown pointers lead to. One whose address is kept
// can be.
#include <ros/ros.h>

struct Point {
  double X;
};

struct Node {
  double Backup, Least;
  Point *Seen = nullptr;
  explicit Node(ros::NodeHandle &Handle) {
    Handle.param("backup", Backup, 0.1);
    Handle.param("least", Least, 0.1);
  }
  void choose(Point &Drive) const { Drive.X = Backup; }
  void keep(Point &Kept) {
    Kept.X = Least;
    Seen = &Kept;
  }
  void step(ros::Publisher &Out, Point **Plan, double Here);
};

// CHECK: comparisons of {{.*}}: 2
void Node::step(ros::Publisher &Out, Point **Plan, double Here) {
  Point Drive, Kept;
  choose(Drive);
  keep(Kept);
  // CHECK-DAG: parameter 'least' relation > {{.*}} at [[#@LINE+1]]:18
  if (Plan[1]->X < Here)
    Out.publish(std_msgs::Number());
  // CHECK-DAG: parameter 'backup' relation > {{.*}} at [[#@LINE+1]]:15
  if (Drive.X < Here)
    Out.publish(std_msgs::Number());
}

Point *Plan[2];

int main() {
  ros::NodeHandle Handle;
  Node N(Handle);
  ros::Publisher Out;
  N.step(Out, Plan, 1);
}
