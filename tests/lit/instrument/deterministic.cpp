// RUN: %native -c %inputs/ros.cpp -o %t.ros.o
// RUN: %compile -O2 %s -o %t.o
// RUN: %link -O2 -Wl,-mllvm,-tpc-link-unit=node -Wl,-mllvm,-tpc-static-info=%t.1.json %t.o %t.ros.o -o %t.1
// RUN: %link -O2 -Wl,-mllvm,-tpc-link-unit=node -Wl,-mllvm,-tpc-static-info=%t.2.json %t.o %t.ros.o -o %t.2
// RUN: cmp %t.1 %t.2
// RUN: cmp %t.1.json %t.2.json
//
// The same input gives the same object code and the same static information.
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
