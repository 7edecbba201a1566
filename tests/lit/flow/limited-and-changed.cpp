// RUN: %compile -O2 %s -o %t.2.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.2.o | FileCheck %s
// RUN: %compile -O0 %s -o %t.0.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.0.o | FileCheck %s
//
// A variable that begins as a measured value within a limit, and is changed
// afterwards, is a command: what it is compared with later is not compared with
// the limit.
#include <ros/ros.h>

#include <algorithm>
#include <cmath>

double wanted();
double reachable();

struct Limits {
  double Most, Least;
};

// CHECK: comparisons of {{.*}}: 5
double drive(const Limits &Own, bool Back) {
  // CHECK-DAG: 'most' relation < {{.*}} at [[#@LINE+2]]:18
  // CHECK-DAG: 'least' relation > {{.*}} at [[#@LINE+1]]:37
  double Speed = std::min(Own.Most, std::max(Own.Least, wanted()));
  Speed = std::min(std::max(std::fabs(Speed), reachable()), reachable());
  // CHECK-DAG: 'most' relation < {{.*}} at [[#@LINE+2]]:11
  // CHECK-DAG: 'least' relation > {{.*}} at [[#@LINE+1]]:30
  Speed = std::min(Own.Most, std::max(Own.Least, Speed));
  if (Back)
    Speed = -Speed;
  return Speed;
}

double turn(const Limits &Own, bool Back) {
  // CHECK-DAG: 'most' relation < {{.*}} at [[#@LINE+1]]:17
  double Rate = std::min(Own.Most, wanted());
  if (Rate < reachable())
    Rate = reachable();
  if (Back)
    Rate = -Rate;
  return Rate;
}

int main() {
  ros::NodeHandle Handle;
  ros::Publisher Out;
  Limits Own;
  Handle.param("most", Own.Most, 1.0);
  Handle.param("least", Own.Least, 0.0);
  std_msgs::Number Message;
  Message.data = drive(Own, wanted() < reachable());
  Out.publish(Message);
  Message.data = turn(Own, wanted() < reachable());
  Out.publish(Message);
}
