// RUN: rm -rf %t && mkdir -p %t
// RUN: %native -c %inputs/ros.cpp -o %t/ros.o
// RUN: %compile -O2 -fPIC %s -o %t/library.o
// RUN: %compile -O2 -fPIC -DMAIN=left -DLIMIT=Left %s -o %t/left.o
// RUN: %compile -O2 -fPIC -DMAIN=right -DLIMIT=Right %s -o %t/right.o
// RUN: %link -O2 -Wl,-mllvm,-tpc-link-unit=left -Wl,-mllvm,-tpc-plan-out=%t/left.plan %t/left.o %t/library.o %t/ros.o -o %t/left
// RUN: %link -O2 -Wl,-mllvm,-tpc-link-unit=right -Wl,-mllvm,-tpc-plan-out=%t/right.plan %t/right.o %t/library.o %t/ros.o -o %t/right
// RUN: %link -O2 -shared -Wl,-mllvm,-tpc-link-unit=library -Wl,-mllvm,-tpc-plan=%t/left.plan -Wl,-mllvm,-tpc-plan=%t/right.plan -Wl,-mllvm,-tpc-static-info=%t/library.json %t/library.o -o %t/liblibrary.so
// RUN: %python -c "import json, sys; [print(c['source'], *c['processes']) for c in json.load(open(sys.argv[1]))['comparisons']]" %t/library.json | FileCheck %s
//
// A library gets what both of its processes found, each place once.
#include <ros/ros.h>

// CHECK: both left right
// CHECK-NEXT: left left
// CHECK-NEXT: right right
// CHECK-NOT: {{.}}

extern double Left, Right;
void step(ros::Publisher &Out, double V);

#ifdef MAIN
#define TEXT(X) #X
#define NAME(X) TEXT(X)
int main(int Argc, char **) {
  ros::NodeHandle Handle;
  Handle.param(NAME(MAIN), LIMIT, 1.0);
  ros::Publisher Out = Handle.advertise<std_msgs::Number>("out", 1);
  step(Out, Argc);
}
#else
double Left = 0, Right = 0;
void step(ros::Publisher &Out, double V) {
  double Both;
  ros::NodeHandle().param("both", Both, 1.0);
  if (V > Both)
    Out.publish(std_msgs::Number());
  if (V > Left)
    Out.publish(std_msgs::Number());
  if (V > Right)
    Out.publish(std_msgs::Number());
}
#endif
