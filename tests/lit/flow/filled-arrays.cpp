// RUN: %compile -O2 %s -o %t.2.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.2.o | FileCheck %s
// RUN: %compile -O0 %s -o %t.0.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.0.o | FileCheck %s
//
// memset writes its value into the object: what decides the value, and whether
// it is written, decides what is read from there.
#include <cstring>
#include <ros/ros.h>

struct Grid {
  unsigned char *Cells, *Apart, Default = 0;
  unsigned Size;
  explicit Grid(unsigned Size)
      : Cells(new unsigned char[Size]), Apart(new unsigned char[Size]),
        Size(Size) {}
};

// The zeros that a compiler writes first are no value of their own.
void compareZeroed(ros::NodeHandle &Handle, ros::Publisher &Out, double Value) {
  double Limits[4] = {};
  Handle.param("zeroed", Limits[2], 1.0);
  // CHECK-DAG: parameter 'zeroed' relation > as x distance 1 {{.*}} at [[#@LINE+1]]:13
  if (Value > Limits[2])
    Out.publish(std_msgs::Number());
}

struct Node {
  bool Unknown;
  double Limit, Farther;
  Grid Map;
  ros::Publisher Out;

  Node(ros::NodeHandle &Handle, unsigned Size) : Map(Size) {
    Handle.param("track_unknown", Unknown, false);
    Handle.param("limit", Limit, 1.0);
    Handle.param("farther", Farther, 1.0);
    // CHECK-DAG: flag 'track_unknown' {{.*}} at [[#@LINE+1]]:9
    if (Unknown)
      Map.Default = 255;
  }
  void reset(double Value);
  void step(unsigned I);
};

void Node::reset(double Value) {
  // CHECK-DAG: parameter 'limit' relation > as x {{.*}} at [[#@LINE+1]]:13
  if (Value > Limit)
    memset(Map.Cells, Map.Default, Map.Size);
  // Nobody reads this array.
  // CHECK-NOT: 'farther'
  if (Value > Farther)
    memset(Map.Apart, Map.Default, Map.Size);
}

void Node::step(unsigned I) {
  std_msgs::Number Message;
  Message.data = Map.Cells[I];
  Out.publish(Message);
}

int main(int Arguments, char **) {
  ros::NodeHandle Handle;
  Node N(Handle, Arguments);
  compareZeroed(Handle, N.Out, Arguments);
  N.reset(Arguments);
  N.step(1);
}
