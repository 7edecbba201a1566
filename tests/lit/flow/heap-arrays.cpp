// RUN: %compile -O2 %s -o %t.2.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.2.o | FileCheck %s
// RUN: %compile -O0 %s -o %t.0.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.0.o | FileCheck %s
//
// An array that the program allocates is one variable where its index is not
// constant. Constant indices are told apart, and so are two arrays.
#include <cstdlib>
#include <memory>
#include <ros/ros.h>

struct Node {
  double *Rows, *Other, *Two;
  int *Counts;
  std::unique_ptr<float[]> Owned;
  unsigned char *Map;
  unsigned Size;

  Node(ros::NodeHandle &Handle, unsigned Size) : Size(Size) {
    double Row;
    Handle.param("row", Row, 1.0);
    Rows = new double[Size];
    for (unsigned I = 0; I < Size; ++I)
      Rows[I] = Row;
    Other = static_cast<double *>(malloc(Size * sizeof(double)));
    Handle.param("other", Other[Size - 1], 1.0);
    Two = new double[2];
    Handle.param("first", Two[0], 1.0);
    Handle.param("second", Two[1], 1.0);
    int Count;
    Handle.param("count", Count, 1);
    Counts = static_cast<int *>(calloc(Size, sizeof(int)));
    for (int *At = Counts; At != Counts + Size; ++At)
      *At = Count;
    float Kept;
    Handle.param("kept", Kept, 1.0f);
    Owned.reset(new float[Size]);
    Owned[Size / 2] = Kept;
    Map = new unsigned char[Size];
    int Cost;
    Handle.param("cost", Cost, 1);
    Map[3] = Cost;
  }
  unsigned char at(unsigned I) const { return Map[I]; }
  void step(ros::Publisher &Out, double Value, unsigned I);
};

// CHECK: comparisons of {{.*}}: 7
void Node::step(ros::Publisher &Out, double Value, unsigned I) {
  // CHECK-DAG: parameter 'row' relation > as x distance 1 {{.*}} at [[#@LINE+1]]:13
  if (Value > Rows[I])
    Out.publish(std_msgs::Number());
  // CHECK-DAG: parameter 'other' relation > as x distance 1 {{.*}} at [[#@LINE+1]]:13
  if (Value > Other[0])
    Out.publish(std_msgs::Number());
  // CHECK-DAG: parameter 'first' relation > as x distance 1 {{.*}} at [[#@LINE+1]]:13
  if (Value > Two[0])
    Out.publish(std_msgs::Number());
  // CHECK-DAG: parameter 'second' relation > as x distance 1 {{.*}} at [[#@LINE+1]]:13
  if (Value > Two[1])
    Out.publish(std_msgs::Number());
  // CHECK-DAG: parameter 'count' relation > as x distance 1 {{.*}} at [[#@LINE+1]]:13
  if (Value > Counts[I])
    Out.publish(std_msgs::Number());
  // CHECK-DAG: parameter 'kept' relation > as x distance 1 {{.*}} at [[#@LINE+1]]:13
  if (Value > Owned[I])
    Out.publish(std_msgs::Number());
  // CHECK-DAG: parameter 'cost' relation < as x distance 1 {{.*}} at [[#@LINE+1]]:13
  if (Value < at(I))
    Out.publish(std_msgs::Number());
}

int main(int Arguments, char **) {
  ros::NodeHandle Handle;
  Node N(Handle, Arguments);
  ros::Publisher Out;
  N.step(Out, Arguments, 1);
}
