// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// A read or write at an index that is not constant, by a moving pointer, or in
// a copy of the whole array can concern any element.
#include <cstring>
#include <ros/ros.h>

double Read[2], Written[2], Walked[3], From[2], To[2];
struct Pair {
  double Values[2];
} Original, Taken;
double Many[100];

// CHECK: comparisons of {{.*}}: 11
void load(ros::NodeHandle &Handle, int I) {
  double Low;
  Handle.param("read", Read[1], 0.5);
  Handle.param("low", Low, 0.5);
  Written[I] = Low;
  Handle.param("walked", Walked[2], 0.5);
  Handle.param("copied", From[1], 0.5);
  std::memcpy(To, From, sizeof To);
  Handle.param("taken 0", Original.Values[0], 0.5);
  Handle.param("taken 1", Original.Values[1], 0.5);
  Taken = Original;
  Handle.param("many 3", Many[3], 0.5);
  Handle.param("many 80", Many[80], 0.5);
}

static bool isOver(const double *Values, int Count, double V) {
  for (int I = 0; I < Count; ++I)
    // CHECK-DAG: parameter 'walked' {{.*}} at [[#@LINE+1]]:11
    if (V > Values[I])
      return true;
  return false;
}

void step(ros::Publisher &Out, double V, int I) {
  std_msgs::Number Message;
  if (V < Read[0])
    Out.publish(Message);
  // CHECK-DAG: parameter 'read' {{.*}} at [[#@LINE+1]]:9
  if (V < Read[I])
    Out.publish(Message);
  // CHECK-DAG: parameter 'low' {{.*}} at [[#@LINE+1]]:9
  if (V < Written[0])
    Out.publish(Message);
  // CHECK-DAG: parameter 'low' {{.*}} at [[#@LINE+1]]:9
  if (V < Written[1])
    Out.publish(Message);
  if (isOver(Walked, 3, V))
    Out.publish(Message);
  for (const double *P = Walked; P != Walked + 3; ++P)
    // CHECK-DAG: parameter 'walked' {{.*}} at [[#@LINE+1]]:11
    if (V < *P)
      Out.publish(Message);
  // CHECK-DAG: parameter 'copied' {{.*}} at [[#@LINE+1]]:9
  if (V < To[1])
    Out.publish(Message);
  // As part of an object, an element is copied as itself.
  // CHECK-DAG: parameter 'taken 0' {{.*}} at [[#@LINE+1]]:9
  if (V < Taken.Values[0])
    Out.publish(Message);
  // CHECK-DAG: parameter 'taken 1' {{.*}} at [[#@LINE+1]]:9
  if (V < Taken.Values[1])
    Out.publish(Message);
  // Elements from the 64th on are not distinguished from any element.
  // CHECK-DAG: parameter 'many 80' {{.*}} at [[#@LINE+1]]:9
  if (V < Many[2])
    Out.publish(Message);
  // CHECK-DAG: parameter 'many 3' {{.*}} at [[#@LINE+2]]:9
  // CHECK-DAG: parameter 'many 80' {{.*}} at [[#@LINE+1]]:9
  if (V < Many[3])
    Out.publish(Message);
}

int main(int Count, char **) {
  ros::NodeHandle Handle;
  ros::Publisher Out;
  load(Handle, Count);
  step(Out, 1, Count);
}
