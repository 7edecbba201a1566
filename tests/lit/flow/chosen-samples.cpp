// RUN: %compile -O2 %s -o %t.2.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.2.o | FileCheck %s
// RUN: %compile -O0 %s -o %t.0.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.0.o | FileCheck %s
//
// A value that is a parameter or something else limits nothing: in an array,
// too, it is a threshold. So is a limited value in a member of an object, where
// the object is one of an array. A variable that is only compared is a
// threshold before and after it is made smaller.
#include <ros/ros.h>

#include <algorithm>

double range();

struct Joint {
  double Limit;
  void load(double Own, double Most) { Limit = std::min(Most, Own); }
  // CHECK-DAG: 'most' relation > {{.*}} at [[#@LINE+1]]:
  bool isPast(double Value) const { return Value > Limit; }
};

struct Node {
  double Most, Limits[4];
  Joint Joints[4];

  void fill(int N, double Given) {
    Limits[N] = Given > 0 ? Given : Most;
    Joints[N].load(Given, Most);
  }
  // CHECK-DAG: 'most' relation > {{.*}} at [[#@LINE+1]]:
  bool isFar(int N, double Value) const { return Value > Limits[N]; }
};

int main() {
  ros::NodeHandle Handle;
  ros::Publisher Out;
  Node Own;
  std_msgs::Number Message;
  Handle.param("most", Own.Most, 1.0);
  for (int N = 0; N < 4; ++N) {
    Own.fill(N, range());
    double Reach = std::min(Own.Most, range());
    // CHECK-DAG: 'most' relation > {{.*}} at [[#@LINE+1]]:
    if (range() > Reach)
      Out.publish(Message);
    Reach = Reach - 0.1;
    // CHECK-DAG: 'most' relation > as x - 0.1 {{.*}} at [[#@LINE+1]]:
    if (range() > Reach)
      Out.publish(Message);
    Message.data = Own.isFar(N, range()) + Own.Joints[N].isPast(range());
    Out.publish(Message);
  }
}
