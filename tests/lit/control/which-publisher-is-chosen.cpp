// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// A predicate that chooses the publisher of a message decides where it is seen;
// one that chooses something that is only counted decides nothing.
// CHECK: comparisons of {{.*}}: 1
// CHECK-NEXT: parameter 'split' relation < as x distance 2
#include <ros/ros.h>

struct Chooser {
  ros::Publisher Left, Right;
  double Split = 0, Note = 0;
  int Notes = 0, Other = 0;

  void onInput(double Value) {
    ros::Publisher &Out = Value < Split ? Left : Right;
    Out.publish(std_msgs::Number());
    int &Counted = Value < Note ? Notes : Other;
    ++Counted;
  }
};

int main(int Count, char **) {
  ros::NodeHandle Handle;
  Chooser C;
  Handle.param("split", C.Split, 1.0);
  Handle.param("note", C.Note, 2.0);
  C.onInput(Count);
}
