// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes=tpc -tpc-static-info=%t.json %t.o
// RUN: %python %inputs/show.py paths %t.json | FileCheck %s --match-full-lines
//
// The path if the outcome is stored, a predicate sets a state that another one
// tests, and an argument and a result pass on what was decided.
#include <ros/ros.h>

class Node {
public:
  explicit Node(ros::NodeHandle &Handle) {
    // CHECK-DAG: near 1: read [[#@LINE+1]] Node::Node: near read into Node::Near
    Handle.param("near", Near, 2.0);
    // CHECK-DAG: degrees 1: read [[#@LINE+2]] Node::Node: degrees read into Degrees
    double Degrees;
    Handle.param("degrees", Degrees, 90.0);
    // CHECK-DAG: degrees 2: store [[#@LINE+1]] Node::Node: stored into Node::Turn
    Turn = Degrees / 2;
    // CHECK-DAG: quiet 1: read [[#@LINE+1]] Node::Node: quiet read into Node::Quiet
    Handle.param("quiet", Quiet, false);
  }

  void watch(double Distance) {
    // CHECK-DAG: near 2: compare [[#@LINE+1]] Node::watch: compared: Distance < Near; outcome stored into Node::Close
    Close = Distance < Near;
  }

  void decide() {
    // CHECK-DAG: near 3: decide [[#@LINE+1]] Node::decide: guards the store to Node::State
    if (Close)
      // CHECK-DAG: near 4: store [[#@LINE+1]] Node::decide: stored into Node::State
      State = 1;
  }

  void tell() {
    // CHECK-DAG: near 5: control [[#@LINE+1]] Node::tell: guards publish()
    if (State == 1)
      // CHECK-DAG: near 6: expose [[#@LINE+1]] Node::tell: published
      Out.publish(std_msgs::Number());
    // CHECK-DAG: quiet 2: decide [[#@LINE+1]] Node::tell: guards publish()
    if (!Quiet)
      // CHECK-DAG: quiet 3: expose [[#@LINE+1]] Node::tell: published
      Out.publish(std_msgs::Number());
  }

  double rate(double Yaw) {
    // The value that the branches choose between is returned.
    // CHECK-DAG: degrees 3: compare [[#@LINE+1]] Node::rate: compared: Yaw > Turn (0.5 * x), x being degrees; chooses the value of Rate
    double Rate = Yaw > Turn ? Yaw : 1;
    // CHECK-DAG: degrees 4: return [[#@LINE+1]] Node::rate: returned by rate()
    return Rate;
  }

  void send(double Value) {
    std_msgs::Number Message;
    // CHECK-DAG: degrees 6: store [[#@LINE+1]] Node::send: stored into Number::data
    Message.data = Value;
    // CHECK-DAG: degrees 7: expose [[#@LINE+1]] Node::send: published
    Out.publish(Message);
  }

  // CHECK-DAG: degrees 5: pass [[#@LINE+1]] Node::turn: handed to send()
  void turn(double Yaw) { send(rate(Yaw)); }

private:
  ros::Publisher Out;
  double Near, Turn;
  bool Quiet, Close = false;
  int State = 0;
};

void run(ros::NodeHandle &Handle) {
  Node N(Handle);
  N.watch(1);
  N.decide();
  N.tell();
  N.turn(1);
}
