// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-loop-depths>' %t.o | FileCheck %s
//
// LoopDepths: the loops around a comparison are those of its function and those
// around the calls that lead there. A loop that waits, itself or in a function
// that it calls, does not count. What waits is told by whole words of a name:
// a robot's joints do not.
#include <algorithm>
#include <ros/ros.h>
#include <unistd.h>
#include <vector>

ros::Publisher Out;

struct Grid {
  double Limit;
  bool isHigh(double V) const {
    // CHECK-DAG: 2 at [[#@LINE+1]]:14
    return V > Limit;
  }
};

void clear(const Grid &G, const double *Cells, int Rows, int Columns) {
  // Once before all cells and once for each: the one with more loops counts.
  if (G.isHigh(*Cells))
    return;
  for (int Row = 0; Row < Rows; ++Row)
    for (int Column = 0; Column < Columns; ++Column)
      if (G.isHigh(Cells[Row * Columns + Column]))
        Out.publish(std_msgs::Number());
}

void rest() { usleep(1000); }

// Functions of other libraries.
double getJointPosition(int Joint);
double joint_angle(int Joint);
bool waitForMessage();
void timed_join(int Thread);

int main() {
  ros::NodeHandle Handle;
  Grid G;
  double Slow, Scanned, Found;
  Handle.param("limit", G.Limit, 0.5);
  Handle.param("slow", Slow, 0.5);
  Handle.param("scanned", Scanned, 0.5);
  Handle.param("found", Found, 0.5);
  std::vector<double> Ranges(100);
  while (true) {
    // CHECK-DAG: 0 at [[#@LINE+1]]:19
    if (Ranges[0] > Slow)
      Out.publish(std_msgs::Number());
    for (double R : Ranges)
      // CHECK-DAG: 1 at [[#@LINE+1]]:13
      if (R > Scanned)
        Out.publish(std_msgs::Number());
    // CHECK-DAG: 1 at [[#@LINE+2]]:46
    if (std::any_of(Ranges.begin(), Ranges.end(),
                    [&](double R) { return R < Found; }))
      Out.publish(std_msgs::Number());
    for (int J = 0; J < 6; ++J)
      // CHECK-DAG: 1 at [[#@LINE+1]]:31
      if (getJointPosition(J) > Scanned)
        Out.publish(std_msgs::Number());
    for (int J = 0; J < 6; ++J)
      // CHECK-DAG: 1 at [[#@LINE+1]]:26
      if (joint_angle(J) > Scanned)
        Out.publish(std_msgs::Number());
    for (int J = 0; J < 6 && waitForMessage(); ++J)
      // CHECK-DAG: 0 at [[#@LINE+1]]:21
      if (Ranges[J] > Scanned)
        Out.publish(std_msgs::Number());
    for (int J = 0; J < 6; ++J) {
      timed_join(J);
      // CHECK-DAG: 0 at [[#@LINE+1]]:21
      if (Ranges[J] > Scanned)
        Out.publish(std_msgs::Number());
    }
    clear(G, Ranges.data(), 10, 10);
    rest();
  }
}
