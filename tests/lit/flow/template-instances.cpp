// RUN: %native -c %inputs/ros.cpp -o %t.ros.o
// RUN: %compile -O2 %s -o %t.o
// RUN: %link -O2 -Wl,-mllvm,-tpc-static-info=%t.json %t.o %t.ros.o -o %t
// RUN: %t | FileCheck %s
// RUN: %python -c "import json,sys; c=[x for x in json.load(open(sys.argv[1]))['comparisons'] if x['source']]; assert len(c) == 1, c; assert c[0]['distance'] == 1 and c[0]['lineno'] == int(sys.argv[2]), c" %t.json 20
//
// The instances of a template are one comparison, with the smallest distance,
// and all of them report under its key.
#include <ros/ros.h>

static ros::Publisher Out;
static double Limit;
static int Last;

template <typename T> struct Above {
  // The instance for int decides a publish directly, the one for double through
  // a member that a later condition reads.
  static __attribute__((noinline)) bool is(T V) {
    // On one line:
    return V > Limit;
  }
};

int main(int Argc, char **) {
  ros::NodeHandle Handle;
  Handle.param("limit", Limit, 0.5);
  Out = Handle.advertise<std_msgs::Number>("out", 1);
  // CHECK: report 1 cmp 1 thresh 0.5 res 1 key [[KEY:....]]
  if (Above<int>::is(Argc))
    Out.publish(std_msgs::Number());
  // CHECK: report 0 cmp 0.25 thresh 0.5 res 0 key [[KEY]]
  if (Above<double>::is(Argc / 4.0))
    Last = 7;
  if (Last == 7)
    Out.publish(std_msgs::Number());
}
