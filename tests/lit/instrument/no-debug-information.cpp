// RUN: %native -c %inputs/ros.cpp -o %t.ros.o
// RUN: %compile -g0 -O2 %s -o %t.o
// RUN: %link -O2 -Wl,-mllvm,-tpc-static-info=%t.json %t.o %t.ros.o -o %t
// RUN: %t | FileCheck %s --implicit-check-not=report
// RUN: FileCheck %s --check-prefix=JSON --input-file=%t.json
//
// Without debug information there are no places: nothing is reported, it is
// counted, and the program is linked.
// CHECK: published out 3
// JSON: "comparisons": 0,
// JSON: "without_debug_info": 3
#include <ros/ros.h>

#include <cstdlib>

class Node {
public:
  explicit Node(ros::NodeHandle &Handle) {
    Handle.param("limit", Limit, 2.5);
    Handle.param("most", Most, 3);
    Handle.param("quiet", Quiet, false);
    Out = Handle.advertise<std_msgs::Number>("out", 1);
  }
  void step(double Value) {
    std_msgs::Number Message;
    Message.data = Value;
    bool Enough = Value > Limit;
    if (Quiet)
      return;
    if (Enough && Count < Most) {
      ++Count;
      Out.publish(Message);
    }
  }

private:
  ros::Publisher Out;
  double Limit;
  int Most, Count = 0;
  bool Quiet;
};

int main() {
  ros::NodeHandle Handle;
  Node N(Handle);
  for (int I = 0; I < 7; ++I)
    N.step(I);
}
