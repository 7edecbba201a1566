// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o 2>&1 | FileCheck %s
//
// A text is replaced in one of several objects before that is published: its
// former value may be in another object. The analysis does not fail.
#include <ros/ros.h>

#include <string>

struct Note : std_msgs::Number {
  std::string Frame;
};

// CHECK: threshold predicate comparisons of {{.*}}: 1
// CHECK-NEXT: parameter 'limit' relation > {{.*}} at [[#@LINE+6]]
static void send(ros::Publisher &Out, Note *Object, const std::string &Frame, double Value,
                 double Limit) {
  // One of the objects passed in.
  Object->Frame = Frame;
  Object->data = 0;
  if (Value > Limit)
    Out.publish(*Object);
}

void step(ros::NodeHandle &Handle, ros::Publisher &Out, const std::string &Frame, double Value) {
  static Note First, Second;
  double Limit = 0;
  Handle.param("limit", Limit, 1.0);
  send(Out, Value > 0 ? &First : &Second, Frame, Value, Limit);
  for (int I = 0; I < 3; ++I)
    send(Out, new Note, Frame, Value, Limit);
}
