// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes=tpc -tpc-static-info=%t.json %t.o
// RUN: %python %inputs/show.py paths %t.json | FileCheck %s --match-full-lines
//
// In a link unit with very many comparisons the paths are shorter: of 10,000
// steps, 1,000 comparisons get 5 each before the predicate and 5 behind it.
// Here these are the read and the comparison and, with the predicate, which is
// on the line of the comparison, two steps, a gap and two steps.
#include <ros/ros.h>

// CHECK-COUNT-1000: limit: 6 steps
// CHECK-NOT: limit: {{.*}} steps
// CHECK: limit 6: expose {{.*}} f0: published

static void f0(ros::Publisher &Out) { Out.publish(std_msgs::Number()); }
static void f1(ros::Publisher &Out) { f0(Out); }
static void f2(ros::Publisher &Out) { f1(Out); }
static void f3(ros::Publisher &Out) { f2(Out); }
static void f4(ros::Publisher &Out) { f3(Out); }
static void f5(ros::Publisher &Out) { f4(Out); }
static void f6(ros::Publisher &Out) { f5(Out); }
static void f7(ros::Publisher &Out) { f6(Out); }
static void f8(ros::Publisher &Out) { f7(Out); }
static void f9(ros::Publisher &Out) { f8(Out); }
static void f10(ros::Publisher &Out) { f9(Out); }

#define TEN(X) X X X X X X X X X X

void step(ros::NodeHandle &Handle, ros::Publisher &Out, double Value) {
  double Limit;
  Handle.param("limit", Limit, 0.5);
  TEN(TEN(TEN(if (Value > Limit) f10(Out);)))
}
