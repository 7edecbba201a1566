// RUN: rm -rf %t && mkdir -p %t
// RUN: %native -c %inputs/ros.cpp -o %t/ros.o
// RUN: %compile -O2 -fPIC -DSTEP=stepOne -DNAME='"one"' %s -o %t/one.o
// RUN: %compile -O2 -fPIC -DSTEP=stepTwo -DNAME='"two"' %s -o %t/two.o
// RUN: %compile -O2 -fPIC -DMAIN %s -o %t/main.o
// RUN: %link -O2 -Wl,-mllvm,-tpc-link-unit=robot -Wl,-mllvm,-tpc-plan-out=%t/robot.plan %t/main.o %t/one.o %t/two.o %t/ros.o -o %t/robot
// RUN: FileCheck %s --check-prefix=PLAN --input-file=%t/robot.plan
// RUN: %link -O2 -shared -Wl,-mllvm,-tpc-link-unit=two -Wl,-mllvm,-tpc-plan=%t/robot.plan -Wl,-mllvm,-tpc-static-info=%t/two.json %t/two.o -o %t/libtwo.so 2>&1 | count 0
// RUN: FileCheck %s --input-file=%t/two.json
//
// Functions that only one file sees may have one name. The linker renamed that
// of the second file, which has its own name in its unit. What tells them apart
// is a text alone, and the linker renamed texts, too.
#include <ros/ros.h>

// PLAN: "name": "_ZL5checkd.{{[0-9]+}}"

// CHECK: "comparisons": [
// CHECK-NOT: "source": "one"
// CHECK: "source": "two"
// CHECK-NOT: "source":
// CHECK: "comparisons": 1,
// CHECK: "not_instrumented": 0,

void stepOne(double V);
void stepTwo(double V);

#ifdef MAIN
int main(int Argc, char **) {
  stepOne(Argc);
  stepTwo(Argc);
}
#else
static __attribute__((noinline)) void check(double V) {
  double Limit;
  ros::NodeHandle Handle;
  Handle.param(NAME, Limit, 1.0);
  if (V > Limit)
    Handle.advertise<std_msgs::Number>("out", 1).publish(std_msgs::Number());
}
void STEP(double V) { check(V); }
#endif
