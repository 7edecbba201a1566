// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// A number of seconds that is put into a ros::Duration and taken out again is
// the same number.
#include <ros/ros.h>

// As in ros/duration.h.
namespace ros {
template <class T> struct DurationBase {
  int32_t sec, nsec;
  double toSec() const { return sec + 1e-9 * nsec; }
};
struct Duration : DurationBase<Duration> {
  explicit Duration(double);
  Duration(int32_t Sec, int32_t Nsec);
};
} // namespace ros

struct Node {
  ros::Duration Member;
  double Timeout;
  explicit Node(double Given) : Member(Given), Timeout(Given) {}
  void step(ros::Publisher &Out, double Age);
};

void Node::step(ros::Publisher &Out, double Age) {
  // CHECK-DAG: parameter 'timeout' relation > as x {{.*}} at [[#@LINE+1]]:11
  if (Age > ros::Duration(Timeout).toSec())
    Out.publish(std_msgs::Number());
  // CHECK-DAG: derived 'timeout' relation > as 2 * x {{.*}} at [[#@LINE+1]]:11
  if (Age > Member.toSec() * 2)
    Out.publish(std_msgs::Number());
  // CHECK-NOT: at [[#@LINE+1]]:
  if (Age > ros::Duration(3, 0).toSec())
    Out.publish(std_msgs::Number());
}

int main() {
  ros::NodeHandle Handle;
  double Timeout;
  Handle.param("timeout", Timeout, 0.5);
  Node N(Timeout);
  ros::Publisher Out;
  N.step(Out, 1);
}
