// RUN: rm -rf %t && mkdir -p %t
// RUN: %native -c %inputs/ros.cpp -o %t/ros.o
// RUN: %compile -O2 -fPIC -DSTEP=stepOne %s -o %t/one.o
// RUN: %compile -O2 -fPIC -DSTEP=stepTwo %s -o %t/two.o
// RUN: %compile -O2 -fPIC -DMAIN %s -o %t/main.o
// RUN: %link -O2 -Wl,-mllvm,-tpc-link-unit=robot -Wl,-mllvm,-tpc-plan-out=%t/robot.plan %t/main.o %t/one.o %t/two.o %t/ros.o -o %t/robot
// RUN: %link -O2 -shared -Wl,-mllvm,-tpc-link-unit=one -Wl,-mllvm,-tpc-static-info=%t/one.json %t/one.o -o %t/libone.so
// RUN: %link -O2 -shared -Wl,-mllvm,-tpc-link-unit=two -Wl,-mllvm,-tpc-static-info=%t/two.json %t/two.o -o %t/libtwo.so
// RUN: %link -O2 -shared -Wl,-mllvm,-tpc-link-unit=one -Wl,-mllvm,-tpc-plan=%t/robot.plan -Wl,-mllvm,-tpc-static-info=%t/one.planned.json %t/one.o -o %t/libone.so
// RUN: %link -O2 -shared -Wl,-mllvm,-tpc-link-unit=two -Wl,-mllvm,-tpc-plan=%t/robot.plan -Wl,-mllvm,-tpc-static-info=%t/two.planned.json %t/two.o -o %t/libtwo.so
// RUN: grep '"key"' %t/one.json > %t/one.keys
// RUN: grep '"key"' %t/two.json > %t/two.keys
// RUN: grep '"key"' %t/one.planned.json | diff %t/one.keys -
// RUN: grep '"key"' %t/two.planned.json | diff %t/two.keys -
// RUN: not diff %t/one.keys %t/two.keys
//
// A function of a header is in two units. Each has the comparison under its own
// key, which is that of the analysis of the unit alone.
#include <ros/ros.h>

void stepOne(double V);
void stepTwo(double V);

#ifdef MAIN
int main(int Argc, char **) {
  stepOne(Argc);
  stepTwo(Argc);
}
#else
inline __attribute__((noinline)) void check(double V) {
  double Limit;
  ros::NodeHandle Handle;
  Handle.param("limit", Limit, 1.0);
  if (V > Limit)
    Handle.advertise<std_msgs::Number>("out", 1).publish(std_msgs::Number());
}
void STEP(double V) { check(V); }
#endif
