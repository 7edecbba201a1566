// RUN: %compile -O1 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// An atomic exchange reads and writes: a flag that a callback sets and a timer
// takes, a state that is left if it is set, one that is entered. One whose old
// value nobody uses decides nothing.
#include <atomic>
#include <ros/ros.h>

static ros::Publisher Out;
static std::atomic<bool> Pending;
static std::atomic<int> State, Mode, Unread;

void take(double Value, double Limit) {
  // CHECK-DAG: parameter 'taken'
  if (Value > Limit)
    Pending = true;
  if (Pending.exchange(false))
    Out.publish(std_msgs::Number());
}

void leave(double Value, double Limit) {
  // CHECK-DAG: parameter 'left'
  if (Value < Limit)
    State = 1;
  int Expected = 1;
  if (State.compare_exchange_strong(Expected, 0))
    Out.publish(std_msgs::Number());
}

void enter(double Value, double Limit) {
  int Expected = 0;
  // CHECK-DAG: parameter 'entered'
  if (Value >= Limit)
    Mode.compare_exchange_strong(Expected, 1);
  if (Mode == 1)
    Out.publish(std_msgs::Number());
}

void forget(double Value, double Limit) {
  int Expected = 0;
  if (Value >= Limit)
    Unread.compare_exchange_strong(Expected, 1);
}

int main(int Argc, char **) {
  ros::NodeHandle Handle;
  Out = Handle.advertise<std_msgs::Number>("out", 1);
  double P, Q, R, S;
  Handle.param("taken", P, 1.0);
  Handle.param("left", Q, 1.0);
  Handle.param("entered", R, 1.0);
  Handle.param("unread", S, 1.0);
  take(Argc, P);
  leave(Argc, Q);
  enter(Argc, R);
  forget(Argc, S);
}
// CHECK-NOT: 'unread'
