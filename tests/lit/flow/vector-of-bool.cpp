// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// The elements of a vector<bool> are bits. The operator of a const one returns the
// bit itself, others a pointer and a mask in registers, through which it is written.
#include <ros/ros.h>
#include <vector>

struct Grid {
  std::vector<bool> Wall, Marked;
  int Occupied;

  Grid(ros::NodeHandle &Handle) : Wall(100, false), Marked(100, false) {
    Handle.param("occupied", Occupied, 4);
  }
  bool occupied(unsigned I) const { return Wall[I] || Marked[I]; }
  void mark(unsigned I, int Hits) {
    // CHECK: parameter 'occupied' {{.*}} at [[#@LINE+1]]:14
    if (Hits >= Occupied)
      Marked[I] = true;
  }
  std_msgs::Number message(unsigned I) const {
    std_msgs::Number Message;
    Message.data = occupied(I) ? 100 : 0;
    return Message;
  }
};

void step(ros::NodeHandle &Handle, ros::Publisher &Out, unsigned I, int Hits) {
  Grid G(Handle);
  G.mark(I, Hits);
  Out.publish(G.message(I));
}
