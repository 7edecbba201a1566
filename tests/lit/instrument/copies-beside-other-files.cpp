// RUN: %native -c %inputs/ros.cpp -o %t.ros.o
// RUN: %compile -O2 %s -o %t.o
// RUN: %compile -O2 -DOTHER=first %s -o %t.1.o
// RUN: %compile -O2 -DOTHER=second %s -o %t.2.o
// RUN: %compile -O2 -DOTHER=third %s -o %t.3.o
// RUN: %link -O2 -Wl,-mllvm,-tpc-link-unit=node %t.o %t.ros.o -o %t.alone
// RUN: env PARAM_p=11 PARAM_q=22 PARAM_a=3 PARAM_b=4 PARAM_c=5 PARAM_d=6 %t.alone > %t.expected
// RUN: FileCheck %s --input-file=%t.expected
// RUN: %link -O2 -Wl,-mllvm,-tpc-link-unit=node %t.o %t.1.o %t.2.o %t.ros.o -o %t.two
// RUN: env PARAM_p=11 PARAM_q=22 PARAM_a=3 PARAM_b=4 PARAM_c=5 PARAM_d=6 %t.two | diff %t.expected -
// RUN: %link -O2 -Wl,-mllvm,-tpc-link-unit=node %t.o %t.1.o %t.2.o %t.3.o %t.ros.o -o %t.three
// RUN: env PARAM_p=11 PARAM_q=22 PARAM_a=3 PARAM_b=4 PARAM_c=5 PARAM_d=6 %t.three | diff %t.expected -
//
// Functions are copied for each of their calls, in several rounds. The result is
// the same if other files are linked too, whose functions have the same name.
// CHECK: report 0 cmp 1 thresh 3 {{.*}} key [[A:....]]
// CHECK-NEXT: report 0 cmp 1 thresh 4 {{.*}} key [[B:....]]
// CHECK-NEXT: report 0 cmp 1 thresh 5 {{.*}} key [[C:....]]
// CHECK-NEXT: report 0 cmp 1 thresh 6 {{.*}} key [[D:....]]
// CHECK-NEXT: report 0 cmp 1 thresh 11 {{.*}} key [[INNER:....]]
// CHECK-NEXT: report 0 cmp 1 thresh 11 {{.*}} key [[OUTER:....]]
// CHECK-NEXT: report 0 cmp 2 thresh 3 {{.*}} key [[A]]
// CHECK-NEXT: report 0 cmp 2 thresh 4 {{.*}} key [[B]]
// CHECK-NEXT: report 0 cmp 2 thresh 5 {{.*}} key [[C]]
// CHECK-NEXT: report 0 cmp 2 thresh 6 {{.*}} key [[D]]
// CHECK-NEXT: report 0 cmp 2 thresh 22 {{.*}} key
// CHECK-NEXT: report 0 cmp 2 thresh 22 {{.*}} key
// CHECK-NOT: report
#include <ros/ros.h>

#ifdef OTHER

static int helper() { return 2; }
int OTHER() { return helper(); }

#else

static ros::NodeHandle Handle;
static ros::Publisher Out;

__attribute__((noinline)) void inner(const char *Name, double V, double Limit) {
  double Own;
  Handle.param(Name, Own, 1.0);
  if (V > Own)
    Out.publish(std_msgs::Number());
  if (V > Limit)
    Out.publish(std_msgs::Number());
}

__attribute__((noinline)) void outer(double V, double Limit) {
  inner("a", V, 100);
  inner("b", V, 200);
  inner("c", V, 300);
  inner("d", V, Limit);
  if (V > Limit)
    Out.publish(std_msgs::Number());
}

int main(int Argc, char **) {
  double P, Q;
  Handle.param("p", P, 1.0);
  Handle.param("q", Q, 1.0);
  outer(Argc, P);
  outer(Argc + 1, Q);
}

#endif
