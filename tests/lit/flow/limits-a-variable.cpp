// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
// RUN: %compile -O0 %s -o %t.0.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.0.o | FileCheck %s
//
// A parameter that limits a measured variable is compared with it there, by
// std::clamp, std::min or by hand. What the variable is compared with later is
// not compared with the parameter. A variable of its own that holds the smaller
// of a parameter and something measured is a threshold.
#include <algorithm>
#include <cmath>
#include <ros/ros.h>

struct Twist {
  double Speed, Turn, Climb;
};

struct Node {
  double Fast, Turning, Climbing, Local, Range, Cap, Narrow;
  Twist Command;
  void configure(ros::NodeHandle &Handle);
  void step(ros::Publisher &Out, double Sensed, double Other, double Sensor);
};

// CHECK: comparisons of {{.*}}: 11
void Node::configure(ros::NodeHandle &Handle) {
  Handle.param("fast", Fast, 0.5);
  Handle.param("turning", Turning, 1.0);
  Handle.param("climbing", Climbing, 1.0);
  Handle.param("local", Local, 1.0);
  Handle.param("range", Range, 2.0);
  Handle.param("cap", Cap, 3.0);
  Handle.param("narrow", Narrow, 3.0);
  // Both are parameters: the smaller one is a threshold, whoever it is.
  // CHECK-DAG: parameter 'range' {{.*}} at [[#@LINE+2]]:11
  // CHECK-DAG: parameter 'cap' {{.*}} at [[#@LINE+1]]:11
  Range = std::min(Range, Cap);
}

void Node::step(ros::Publisher &Out, double Sensed, double Other,
                double Sensor) {
  Command.Speed = Sensed;
  Command.Turn = 2 * Sensed;
  Command.Climb = 3 * Sensed;
  // CHECK-DAG: parameter 'fast' relation > as x {{.*}} at [[#@LINE+2]]:19
  // CHECK-DAG: derived 'fast' relation < as -1 * x {{.*}} at [[#@LINE+1]]:19
  Command.Speed = std::clamp(Command.Speed, -Fast, Fast);
  if (std::fabs(Command.Speed) < Other)
    Out.publish(std_msgs::Number());
  // CHECK-DAG: parameter 'turning' relation > as x {{.*}} at [[#@LINE+1]]:20
  if (Command.Turn > Turning)
    Command.Turn = Turning;
  if (std::fabs(Command.Turn) < Other)
    Out.publish(std_msgs::Number());
  // CHECK-DAG: derived 'climbing' relation < as -1 * x {{.*}} at [[#@LINE+1]]:21
  if (Command.Climb < -Climbing)
    Command.Climb = -Climbing;
  if (std::fabs(Command.Climb) < Other)
    Out.publish(std_msgs::Number());
  double Mine = Sensed + Other;
  // CHECK-DAG: parameter 'local' relation > as x {{.*}} at [[#@LINE+1]]:12
  if (Mine > Local)
    Mine = Local;
  if (std::fabs(Mine) < Other)
    Out.publish(std_msgs::Number());
  // CHECK-DAG: parameter 'narrow' {{.*}} at [[#@LINE+1]]:24
  const double Least = std::min(Narrow, Sensor);
  // CHECK-DAG: parameter 'narrow' relation > as x {{.*}} at [[#@LINE+1]]:13
  if (Other > Least)
    Out.publish(std_msgs::Number());
  // CHECK-DAG: parameter 'range' relation > as x {{.*}} at [[#@LINE+2]]:13
  // CHECK-DAG: parameter 'cap' relation > as x {{.*}} at [[#@LINE+1]]:13
  if (Other > Range)
    Out.publish(std_msgs::Number());
  std_msgs::Number Sum;
  Sum.data = Command.Speed + Command.Turn + Command.Climb + Mine;
  Out.publish(Sum);
}
