// RUN: %compile -O2 %s -o %t.2.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-param-calls>,print<tpc-gather-results>' %t.2.o | FileCheck %s
// RUN: %compile -O0 %s -o %t.0.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-param-calls>,print<tpc-gather-results>' %t.0.o | FileCheck %s
//
// Above -O0, a constructor that is not inline has two names for one body; what
// its calls pass is known anyway.
#include <ros/ros.h>

class Part {
public:
  Part(ros::NodeHandle &Handle, double Most);
  void step(double V);

private:
  ros::Publisher Out;
  double Limit, Most;
};

class Node {
public:
  explicit Node(ros::NodeHandle &Handle);
  Part P;
};

Part::Part(ros::NodeHandle &Handle, double Most) : Most(Most) {
  // CHECK-DAG: 'arm/limit' double
  Handle.param("limit", Limit, 1.0);
  Out = Handle.advertise<std_msgs::Number>("out", 1);
}

void Part::step(double V) {
  // CHECK-DAG: parameter 'arm/limit' relation > as x {{.*}} at [[#@LINE+2]]:9
  // CHECK-DAG: parameter '~most' relation < as x {{.*}} at [[#@LINE+1]]:22
  if (V > Limit && V < Most)
    Out.publish(std_msgs::Number());
}

static double most() {
  return ros::NodeHandle("~").param("most", 2.0);
}

Node::Node(ros::NodeHandle &Handle) : P(Handle, most()) {}

int main() {
  ros::NodeHandle Arm("arm");
  Node N(Arm);
  N.P.step(1);
}
