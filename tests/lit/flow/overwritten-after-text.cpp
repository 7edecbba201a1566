// RUN: %compile -O0 %s -o %t.0.o
// RUN: %opt -disable-output -passes='internalize,tpc-prepare,print<tpc-gather-results>' -internalize-public-api-list=main %t.0.o | FileCheck %s
// RUN: %compile -O1 %s -o %t.1.o
// RUN: %opt -disable-output -passes='internalize,tpc-prepare,print<tpc-gather-results>' -internalize-public-api-list=main %t.1.o | FileCheck %s
//
// Between the read of a member and the write that replaces it, the name of the
// parameter is destroyed. At -O0 only the names of the members of its class are
// known. It stores no functions that could see the member, unlike a
// std::function.
#include <functional>
#include <ros/ros.h>
#include <string>

void take(const std::function<void()> &);

struct Node {
  Node() {
    std::string Name = "fixed";
    Handle.param(Name, Fixed, -1.0);
    Name.~basic_string();
    new (&Name) std::string;
    Fixed = -2.0;
    std::function<void()> Check = [this] { check(); };
    Handle.param("seen", Seen, -1.0);
    take(Check);
    Seen = -2.0;
  }
  void check() {
    // CHECK-NOT: 'fixed'
    if (Value < Fixed)
      Out.publish(std_msgs::Number());
    // CHECK: parameter 'seen'
    if (Value < Seen)
      Out.publish(std_msgs::Number());
  }
  ros::NodeHandle Handle;
  ros::Publisher Out = Handle.advertise<std_msgs::Number>("out", 1);
  double Fixed, Seen, Value = 0;
};

int main() {
  Node It;
  It.check();
}
// CHECK-NOT: 'fixed'
