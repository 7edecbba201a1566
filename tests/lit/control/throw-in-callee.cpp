// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// A throw in user code in a called function decides whether the code behind the
// call runs, and what its handler does. The call is a step, like a predicate,
// and the throw another.
#include <ros/ros.h>

#include <stdexcept>
#include <string>

struct Fault {};

double Direct, Deep, Handled, Late, Typed;

// CHECK: comparisons of {{.*}}: 5
void check(double V) {
  // Publish: round 1; the call: 2; the throw: 3.
  // CHECK: 'direct' {{.*}} distance 3 {{.*}} at [[#@LINE+1]]:
  if (V > Direct)
    throw std::runtime_error("over by " + std::to_string(V - Direct));
}
void afterCall(ros::Publisher &Out, double V) {
  check(V);
  Out.publish(std_msgs::Number());
}

void inner(double V) {
  // CHECK: 'deep' {{.*}} distance 4 {{.*}} at [[#@LINE+1]]:
  if (V > Deep)
    throw Fault();
}
void outer(double V) { inner(V); }
void afterTwoCalls(ros::Publisher &Out, double V) {
  outer(V);
  Out.publish(std_msgs::Number());
}

void checkHandled(double V) {
  // CHECK: 'handled' {{.*}} distance 3 {{.*}} at [[#@LINE+1]]:
  if (V > Handled)
    throw Fault();
}
void inHandler(ros::Publisher &Out, double V) {
  try {
    checkHandled(V);
  } catch (const Fault &) {
    Out.publish(std_msgs::Number());
  }
}

void here(ros::Publisher &Out, double V) {
  try {
    // CHECK: 'late' {{.*}} distance 1 {{.*}} at [[#@LINE+1]]:
    if (V > Late)
      throw Fault();
  } catch (const Fault &) {
    Out.publish(std_msgs::Number());
  }
}

void checkTyped(double V) {
  // CHECK: 'typed' {{.*}} distance 3 {{.*}} at [[#@LINE+1]]:
  if (V > Typed)
    throw std::runtime_error("over");
}
void otherHandler(ros::Publisher &Out, double V) {
  try {
    checkTyped(V);
  } catch (const std::logic_error &) {
  }
  Out.publish(std_msgs::Number());
}

void read(ros::NodeHandle &Handle) {
  Handle.param("direct", Direct, 1.0);
  Handle.param("deep", Deep, 1.0);
  Handle.param("handled", Handled, 1.0);
  Handle.param("late", Late, 1.0);
  Handle.param("typed", Typed, 1.0);
}
