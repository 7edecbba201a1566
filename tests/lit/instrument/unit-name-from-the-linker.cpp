// RUN: mkdir -p %t.dir
// RUN: %compile -fPIC -O2 %s -o %t.o
// RUN: %link -shared -O2 -Wl,-mllvm,-tpc-static-info=%t.json %t.o -o %t.dir/libby.so
// RUN: FileCheck %s --input-file=%t.json
//
// By default the link unit has the name of the linker's output; shared
// libraries are link units too.
// CHECK: "comparisons": 1,
// CHECK: "link_unit": "libby.so"
#include <ros/ros.h>

void step(ros::NodeHandle &Handle, ros::Publisher &Out, double V) {
  double Limit;
  Handle.param("limit", Limit, 4.5);
  if (V > Limit)
    Out.publish(std_msgs::Number());
}
