// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o 2>&1 | FileCheck %s
//
// A static method of a container has no object: std::deque asks one how many
// elements fit into a node. The analysis does not fail.
#include <ros/ros.h>

#include <deque>
#include <string>

struct Waiting {
  std::string Text;
  int Age;
};

// CHECK: threshold predicate comparisons of {{.*}}: 1
// CHECK-NEXT: parameter 'oldest' relation > {{.*}} at [[#@LINE+7]]
void step(ros::NodeHandle &Handle, ros::Publisher &Out, std::deque<Waiting> &Queue) {
  int Oldest = 0;
  Handle.param("oldest", Oldest, 3);
  Queue.resize(7);
  Queue.insert(Queue.begin(), 3, Waiting());
  Queue.erase(Queue.begin());
  if (Queue.front().Age > Oldest)
    Out.publish(std_msgs::Number());
}
