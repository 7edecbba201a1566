// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes=tpc -tpc-static-info=%t.json %t.o
// RUN: %python %inputs/show.py paths %t.json | FileCheck %s --match-full-lines
//
// If the path to the exposing statement has more than 32 steps, the middle is
// left out: the predicate, 41 calls and the publish are 43 steps.
#include <ros/ros.h>

// CHECK: limit: 33 steps
// CHECK: limit 2: compare {{.*}} step: compared: Value > Limit; guards the call of f40()
// CHECK: limit 17: call {{.*}} f27: calls f26()
// CHECK-NEXT: limit 18: omitted 0 : 12 steps left out
// CHECK-NEXT: limit 19: call {{.*}} f14: calls f13()
// CHECK: limit 33: expose {{.*}} f0: published

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
static void f11(ros::Publisher &Out) { f10(Out); }
static void f12(ros::Publisher &Out) { f11(Out); }
static void f13(ros::Publisher &Out) { f12(Out); }
static void f14(ros::Publisher &Out) { f13(Out); }
static void f15(ros::Publisher &Out) { f14(Out); }
static void f16(ros::Publisher &Out) { f15(Out); }
static void f17(ros::Publisher &Out) { f16(Out); }
static void f18(ros::Publisher &Out) { f17(Out); }
static void f19(ros::Publisher &Out) { f18(Out); }
static void f20(ros::Publisher &Out) { f19(Out); }
static void f21(ros::Publisher &Out) { f20(Out); }
static void f22(ros::Publisher &Out) { f21(Out); }
static void f23(ros::Publisher &Out) { f22(Out); }
static void f24(ros::Publisher &Out) { f23(Out); }
static void f25(ros::Publisher &Out) { f24(Out); }
static void f26(ros::Publisher &Out) { f25(Out); }
static void f27(ros::Publisher &Out) { f26(Out); }
static void f28(ros::Publisher &Out) { f27(Out); }
static void f29(ros::Publisher &Out) { f28(Out); }
static void f30(ros::Publisher &Out) { f29(Out); }
static void f31(ros::Publisher &Out) { f30(Out); }
static void f32(ros::Publisher &Out) { f31(Out); }
static void f33(ros::Publisher &Out) { f32(Out); }
static void f34(ros::Publisher &Out) { f33(Out); }
static void f35(ros::Publisher &Out) { f34(Out); }
static void f36(ros::Publisher &Out) { f35(Out); }
static void f37(ros::Publisher &Out) { f36(Out); }
static void f38(ros::Publisher &Out) { f37(Out); }
static void f39(ros::Publisher &Out) { f38(Out); }
static void f40(ros::Publisher &Out) { f39(Out); }

void step(ros::NodeHandle &Handle, ros::Publisher &Out, double Value) {
  double Limit;
  Handle.param("limit", Limit, 0.5);
  if (Value > Limit)
    f40(Out);
}
