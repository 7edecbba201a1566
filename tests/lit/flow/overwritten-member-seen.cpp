// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// A member that is overwritten later is seen earlier by code that runs in
// between: a called method, callbacks and other threads if the function waits,
// and any reader if it is atomic. Code that runs in between without reading it
// changes nothing.
#include <ros/ros.h>

#include <atomic>

void sleepFor(double Seconds);
int steadyClock();

struct Node {
  ros::Publisher Out;
  double Called, Uncalled, Slept, Timed, Loaded;
  double A = 0, B = 0, C = 0, D = 0;
  std::atomic<int> E{0};
  explicit Node(ros::NodeHandle &Handle);
  void send(double Value);
  void sendA() { send(A); }
  void callback() { send(B + C + D + E); }
  void step(double V);
};

Node::Node(ros::NodeHandle &Handle) {
  Handle.param("called", Called, 1.0);
  Handle.param("uncalled", Uncalled, 1.0);
  Handle.param("slept", Slept, 1.0);
  Handle.param("timed", Timed, 1.0);
  Handle.param("loaded", Loaded, 1.0);
}

void Node::send(double Value) {
  std_msgs::Number Message;
  Message.data = Value;
  Out.publish(Message);
}

// CHECK: comparisons of {{.*}}: 3
void Node::step(double V) {
  // CHECK-DAG: parameter 'called' {{.*}} at [[#@LINE+1]]:9
  A = V > Called ? 1 : 0;
  sendA();
  A = 0;

  B = V > Uncalled ? 1 : 0;
  sendA();
  B = 0;

  // CHECK-DAG: parameter 'slept' {{.*}} at [[#@LINE+1]]:9
  C = V > Slept ? 1 : 0;
  sleepFor(1);
  C = 0;

  D = V > Timed ? 1 : 0;
  steadyClock();
  D = 0;

  // CHECK-DAG: parameter 'loaded' {{.*}} at [[#@LINE+1]]:9
  E = V > Loaded ? 1 : 0;
  E = 0;
}

int main() {
  ros::NodeHandle Handle;
  Node N(Handle);
  N.step(1);
  N.callback();
}
