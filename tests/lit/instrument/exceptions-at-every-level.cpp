// RUN: %native -c %inputs/ros.cpp -o %t.ros.o
// RUN: %compile -O0 %s -o %t.0.o
// RUN: %link -O0 %t.0.o %t.ros.o -o %t.0
// RUN: %t.0 | FileCheck %s
// RUN: %compile -O1 %s -o %t.1.o
// RUN: %link -O1 %t.1.o %t.ros.o -o %t.1
// RUN: %t.1 | FileCheck %s
// RUN: %compile -O2 %s -o %t.2.o
// RUN: %link -O2 %t.2.o %t.ros.o -o %t.2
// RUN: %t.2 | FileCheck %s
// RUN: %compile -O3 %s -o %t.3.o
// RUN: %link -O3 %t.3.o %t.ros.o -o %t.3
// RUN: %t.3 | FileCheck %s
//
// Exceptions that are thrown between reports, through destructors that compare
// and report, out of a condition and again out of a handler, arrive as before.
// Limit is 2. check(1): 1 > 2 is false, in ~Mark too. check(3): 3 > 2 throws 3
// out of the condition; during unwinding ~Mark compares 3 with the limit and
// publishes. The handler throws 3 + 1, and another Mark (of 4) is unwound.
// CHECK: report 0 cmp 1 thresh 2 res 0
// CHECK-NEXT: published checked 1
// CHECK-NEXT: report 0 cmp 1 thresh 2 res 0
// CHECK-NEXT: published passed 1
// CHECK-NEXT: report 1 cmp 3 thresh 2 res 1
// CHECK-NEXT: report 1 cmp 3 thresh 2 res 1
// CHECK-NEXT: published mark 3
// CHECK-NEXT: report 1 cmp 4 thresh 2 res 1
// CHECK-NEXT: published mark 4
// CHECK-NEXT: published caught 4
#include <ros/ros.h>

static double Limit;

static void send(const char *Topic, double V) {
  ros::NodeHandle Handle;
  std_msgs::Number Message;
  Message.data = V;
  Handle.advertise<std_msgs::Number>(Topic, 1).publish(Message);
}

struct Mark {
  double V;
  ~Mark() {
    if (V > Limit)
      send("mark", V);
  }
};

static bool check(double V) {
  if (V > Limit)
    throw V;
  send("checked", V);
  return true;
}

static void step(double V) {
  Mark M{V};
  if (check(V) && V > 0)
    return;
}

static void twice(double V) {
  try {
    step(V);
    send("passed", V);
  } catch (double Thrown) {
    Mark M{Thrown + 1};
    throw Thrown + 1;
  }
}

int main() {
  ros::NodeHandle Handle;
  Handle.param("limit", Limit, 2.0);
  try {
    twice(1);
    twice(3);
  } catch (double V) {
    send("caught", V);
  }
}
