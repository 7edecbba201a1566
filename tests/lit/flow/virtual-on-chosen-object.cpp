// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// The choice between the classes behind an interface decides what a virtual
// call does: whether something is published, or which value.
#include <ros/ros.h>

#include <memory>

double sensed();

struct Way {
  virtual ~Way() = default;
  virtual void act(ros::Publisher &) {}
  virtual double scaled(double V) { return V; }
};

struct Loud : Way {
  void act(ros::Publisher &Out) override { Out.publish(std_msgs::Number()); }
  double scaled(double V) override { return 2 * V; }
};

struct Node {
  double Limit, Fast, Idle;
  std::unique_ptr<Way> Acting;
  Way *Scaling = nullptr, *Silent = nullptr;
  ros::Publisher Out;

  explicit Node(ros::NodeHandle &Handle) {
    Handle.param("limit", Limit, 1.0);
    Handle.param("fast", Fast, 1.0);
    Handle.param("idle", Idle, 1.0);
    // CHECK: comparisons of {{.*}}: 2
    // Publish (1), the call (2), the pointer (3), what is stored there (4).
    // CHECK-DAG: 'limit' relation < as x distance 4 {{.*}} at [[#@LINE+1]]:18
    if (sensed() < Limit)
      Acting.reset(new Loud);
    else
      Acting.reset(new Way);
    // Publish (1), the message's store (2), the call (3), the pointer (4), what
    // is stored there (5).
    // CHECK-DAG: 'fast' relation < as x distance 5 {{.*}} at [[#@LINE+1]]:18
    if (sensed() < Fast)
      Scaling = new Loud;
    else
      Scaling = new Way;
    // Only the destructor of this one is called.
    if (sensed() < Idle)
      Silent = new Loud;
  }

  void act() { Acting->act(Out); }
  void tell() {
    std_msgs::Number Message;
    Message.data = Scaling->scaled(3);
    Out.publish(Message);
    delete Silent;
  }
};

int main() {
  ros::NodeHandle Handle;
  Node It(Handle);
  It.act();
  It.tell();
}
