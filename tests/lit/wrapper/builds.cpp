// RUN: rm -rf %t && mkdir -p %t && cd %t && cp %s node.cpp
// RUN: export TPC_SOURCE_ROOT=%t && export TPC_PACKAGE=hand
// RUN: %tpc-clang++ -std=c++17 -isystem %inputs/include -O2 -Wall -Werror -DLIBRARY -fPIC -c node.cpp -o step.o
// RUN: %tpc-clang++ -std=c++17 -isystem %inputs/include -O2 -Wall -Werror -c node.cpp -o main.o
// RUN: %tpc-ar rcs libstep.a step.o
// RUN: %native -fPIC -c %inputs/ros.cpp -o ros.o
// RUN: %tpc-clang++ -shared step.o -o libstep.so.1
// RUN: %tpc-clang++ main.o ros.o -o whole -L. -lstep
// RUN: %tpc-clang++ main.o ros.o -o parted ./libstep.so.1 -Wl,-rpath,%t
// RUN: FileCheck %s --input-file=tpc/whole.json
// RUN: FileCheck %s --input-file=tpc/step.json
// RUN: FileCheck %s --input-file=tpc/parted.json --check-prefix=NONE
// RUN: ./whole | FileCheck %s --check-prefix=REPORTS
// RUN: ./parted | FileCheck %s --check-prefix=REPORTS
//
// A hand-written build: the bitcode in the archive is part of the program, the shared
// library is a link unit of its own, and each comparison is listed where it was linked.
// CHECK: "file": "node.cpp"
// CHECK: "source": "limit"
// CHECK: "link_unit": "{{whole|step}}"
// CHECK: "package": "hand"
// NONE: "comparisons": []
// REPORTS: report 1 cmp 1 thresh 0.5 res 1
// REPORTS: published out 0
#include <ros/ros.h>

void step(double Value);

#ifdef LIBRARY
void step(double Value) {
  ros::NodeHandle Node;
  ros::Publisher Out = Node.advertise<std_msgs::Number>("out", 1);
  double Limit = 0;
  Node.param("limit", Limit, 0.5);
  if (Value > Limit)
    Out.publish(std_msgs::Number());
}
#else
int main(int Count, char **) { step(Count); }
#endif
