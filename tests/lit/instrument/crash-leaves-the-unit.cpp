// RUN: %native -c %inputs/ros.cpp -o %t.ros.o
// RUN: %compile -O2 %s -o %t.o
// RUN: %link -O2 -Wl,-mllvm,-tpc-inject-failure -Wl,-mllvm,-tpc-link-unit=node -Wl,-mllvm,-tpc-static-info=%t.json %t.o %t.ros.o -o %t 2>&1 | FileCheck %s --check-prefix=WARN
// RUN: %t | FileCheck %s --implicit-check-not=report
// RUN: FileCheck %s --check-prefix=JSON --input-file=%t.json
//
// A crash inside the analysis costs one warning and a record, not the build:
// the program is linked without reports.
// WARN: warning: node: the analysis crashed; this link unit is left as it was
// WARN-NOT: {{.}}
// CHECK: published out 3
// JSON-DAG: "status": "failed"
// JSON-DAG: "failure": "the analysis crashed"
// JSON-DAG: "comparisons": []
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
