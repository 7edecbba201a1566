// RUN: %native -c %inputs/ros.cpp -o %t.ros.o
// RUN: %compile -O2 %s -o %t.o
// RUN: %compile -O2 -DOTHER %s -o %t.other.o
// RUN: %link -O2 -Wl,-mllvm,-tpc-static-info=%t.json %t.o %t.other.o %t.ros.o -o %t
// RUN: %t | FileCheck %s --check-prefix=WITHOUT
// RUN: FileCheck %s --check-prefix=JSON --input-file=%t.json
// RUN: %link -O2 -Wl,-mllvm,-tpc-constants %t.o %t.other.o %t.ros.o -o %t.all
// RUN: %t.all | FileCheck %s --check-prefix=WITH
//
// Comparisons with constants are always in the static information; they are
// reported if an option asks for it.
#include <ros/ros.h>

// WITHOUT-NOT: report
// WITHOUT: published out 0
// WITHOUT-NOT: report

// JSON: "default": null,
// JSON: "name": "Most",
// JSON: "param_reads": [],
// JSON: "read_at": null,
// JSON: "relation": "<",
// JSON: "source": null,
// JSON: "type": "constant"
// JSON: "comparisons": 0,
// JSON: "constants": 1,
extern const unsigned Most;
#ifdef OTHER
const unsigned Most = 3000000000u;
#else
int main(int Argc, char **) {
  ros::NodeHandle Handle;
  ros::Publisher Out = Handle.advertise<std_msgs::Number>("out", 1);
  unsigned Value = Argc;
  // WITH: report 1 cmp 1 thresh 3000000000 res 1
  // WITH-NEXT: published out 0
  if (Value < Most)
    Out.publish(std_msgs::Number());
}
#endif
