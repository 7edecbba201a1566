// RUN: %native -c %inputs/ros.cpp -o %t.ros.o
// RUN: %compile -O0 %s -o %t.0.o
// RUN: %link -O0 -Wl,-mllvm,-tpc-link-unit=node -Wl,-mllvm,-tpc-static-info=%t.0.json %t.0.o %t.ros.o -o %t.0
// RUN: %compile -O1 %s -o %t.1.o
// RUN: %link -O1 -Wl,-mllvm,-tpc-link-unit=node -Wl,-mllvm,-tpc-static-info=%t.1.json %t.1.o %t.ros.o -o %t.1
// RUN: %compile -O2 %s -o %t.2.o
// RUN: %link -O2 -Wl,-mllvm,-tpc-link-unit=node -Wl,-mllvm,-tpc-static-info=%t.2.json %t.2.o %t.ros.o -o %t.2
// RUN: %compile -O3 %s -o %t.3.o
// RUN: %link -O3 -Wl,-mllvm,-tpc-link-unit=node -Wl,-mllvm,-tpc-static-info=%t.3.json %t.3.o %t.ros.o -o %t.3
// RUN: %python -c "import json,sys; a=[json.load(open(p))['comparisons'] for p in sys.argv[1:]]; assert len(a[0]) == 3, a[0]; assert all(x == a[0] for x in a), a" %t.0.json %t.1.json %t.2.json %t.3.json
//
// The comparisons, with keys and distances, are the same at -O0, -O1, -O2 and
// -O3.
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
