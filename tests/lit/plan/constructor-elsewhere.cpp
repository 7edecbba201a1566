// RUN: rm -rf %t && mkdir -p %t
// RUN: %native -c %inputs/ros.cpp -o %t/ros.o
// RUN: %compile -O2 -fPIC -DLIBRARY %s -o %t/library.o
// RUN: %compile -O2 -fPIC %s -o %t/main.o
// RUN: %link -O2 -Wl,-mllvm,-tpc-link-unit=robot -Wl,-mllvm,-tpc-plan-out=%t/robot.plan %t/main.o %t/library.o %t/ros.o -o %t/robot
// RUN: %link -O2 -shared -Wl,-mllvm,-tpc-link-unit=library -Wl,-mllvm,-tpc-plan=%t/robot.plan %t/library.o -o %t/liblibrary.so
// RUN: %link -O2 -Wl,-mllvm,-tpc-link-unit=main -Wl,-mllvm,-tpc-plan=%t/robot.plan %t/main.o %t/liblibrary.so -rdynamic %t/ros.o -Wl,-rpath,%t -o %t/main 2>&1 | count 0
// RUN: %t/main | FileCheck %s
//
// A constructor that the library defines is one function with two names there.
// Its caller is the same function, although only one name is known here.
#include <ros/ros.h>

struct Made {
  Made();
  virtual ~Made();
  int Number;
};

#ifdef LIBRARY
Made::Made() : Number(1) {}
Made::~Made() {}
#else
// CHECK: report 1 cmp 5 thresh 1
int main(int Argc, char **) {
  Made Object;
  ros::NodeHandle Handle;
  double Limit;
  Handle.param("limit", Limit, 1.0);
  ros::Publisher Out = Handle.advertise<std_msgs::Number>("out", 1);
  if (4 * Argc + Object.Number > Limit)
    Out.publish(std_msgs::Number());
}
#endif
