// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// A local variable is written by a function that gets a pointer to it which may
// also lead elsewhere, or that another function returned. Comparing or
// subtracting its address passes it to nobody.
#include <ros/ros.h>

struct Reader {
  ros::NodeHandle Handle;
  __attribute__((noinline)) static double *same(double *Value) { return Value; }
  void fillMerged(double *Out) { Handle.param("merged", *Out, 1.0); }
  void fillWalked(double *Out) { Handle.param("walked", *Out, 1.0); }
  void fillReturned(double *Out) { Handle.param("returned", *Out, 1.0); }
  void fillAgain(double *Out) { Handle.param("again", *Out, 1.0); }
  void fillCompared(double *Out) { Handle.param("compared", *Out, 1.0); }
};

// CHECK: comparisons of {{.*}}: 3
void merged(Reader &R, ros::Publisher &Out, double V, bool First) {
  double A = 0, B = 0;
  double *Chosen = First ? &A : &B;
  R.fillMerged(Chosen);
  // CHECK-DAG: parameter 'merged' relation > {{.*}} at [[#@LINE+1]]:9
  if (V > A)
    Out.publish(std_msgs::Number());
}

void walked(Reader &R, ros::Publisher &Out, double V) {
  double Pair[2] = {0, 0};
  double *At = Pair;
  for (int I = 0; I < 2; ++I)
    R.fillWalked(At++);
  // CHECK-DAG: parameter 'walked' relation > {{.*}} at [[#@LINE+1]]:9
  if (V > Pair[1])
    Out.publish(std_msgs::Number());
}

void returned(Reader &R, ros::Publisher &Out, double V) {
  double A;
  double *Same = R.same(&A);
  A = 0;
  R.fillReturned(Same);
  // CHECK-DAG: parameter 'returned' relation > {{.*}} at [[#@LINE+1]]:9
  if (V > A)
    Out.publish(std_msgs::Number());
}

void again(Reader &R, ros::Publisher &Out, double V, bool First) {
  double A = 0, B = 0;
  double *Chosen = First ? &A : &B;
  R.fillAgain(Chosen);
  A = 2;
  if (V > A)
    Out.publish(std_msgs::Number());
}

void compared(Reader &R, ros::Publisher &Out, double V, double *Other) {
  double A = 0;
  R.fillCompared(&A);
  bool Far = &A - Other > 100 || &A == Other;
  A = 2;
  if (V > A && Far)
    Out.publish(std_msgs::Number());
}
