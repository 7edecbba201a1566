// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
// RUN: %compile -O0 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// After the clean-up of a local whose scope `continue` leaves, a switch says
// where to go on. Its default is never taken, so the end of the loop follows in
// any case: what skips an element does not decide what comes after the loop.
// CHECK: comparisons of {{.*}}: 1
// CHECK: 'show'
// CHECK-NOT: 'high'
// CHECK-NOT: 'far'
#include <ros/ros.h>

bool toMap(double X, unsigned &Cell);
bool mark(unsigned Cell, double Value);

struct Node {
  double High, Far;
  bool Show;
  void step(const double *Points, int N, ros::Publisher &Out) {
    for (int I = 0; I < N; ++I) {
      if (Points[I] > High)
        continue;
      double Square = Points[I] * Points[I];
      if (Square > Far)
        continue;
      unsigned Cell;
      if (Points[I] < 0) {
        if (!toMap(0, Cell))
          continue;
      } else if (!toMap(Points[I], Cell)) {
        continue;
      }
      if (mark(Cell, Points[I]))
        mark(Cell + 1, 0);
    }
    if (Show)
      Out.publish(std_msgs::Number());
  }
};

void run(ros::NodeHandle &Handle, const double *Points, int Size,
         ros::Publisher &Out) {
  Node N;
  Handle.param("high", N.High, 1.0);
  Handle.param("far", N.Far, 1.0);
  Handle.param("show", N.Show, true);
  N.step(Points, Size, Out);
}
