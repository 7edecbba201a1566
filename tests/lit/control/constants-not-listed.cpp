// RUN: %compile -O2 %s -o %t.2.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.2.o | FileCheck %s
// RUN: %compile -O0 %s -o %t.0.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.0.o | FileCheck %s
//
// These are not comparisons with a constant: pointers, truth values, a number
// used as a condition or compared with 0 instead, comparisons with a parameter,
// comparisons that expose nothing, text, and the tests of a logging macro.
#include <ros/ros.h>

static int Count;

int count();

// Written as the macros of ros/console.h are.
namespace ros::console {
struct LogLocation {
  int Level;
};
} // namespace ros::console
static ros::console::LogLocation Location;

void step(ros::NodeHandle &Handle, ros::Publisher &Out, int N, int *P, bool B,
          double V, const std::string &S) {
  // CHECK: comparisons of {{.*}}: 2
  // CHECK: comparisons with constants: 0
  if (P != nullptr || !P)
    Out.publish(std_msgs::Number());
  if (B == true || B != false)
    Out.publish(std_msgs::Number());
  if (N)
    Out.publish(std_msgs::Number());
  if (!N || V || N != 0)
    Out.publish(std_msgs::Number());
  while (count())
    Out.publish(std_msgs::Number());
  if (N > 3)
    ++Count;
  if (__builtin_expect(Location.Level != 1, 0))
    Out.publish(std_msgs::Number());
  int M;
  Handle.param("m", M, 5);
  if (M > 3)
    Out.publish(std_msgs::Number());
  std::string Mode;
  Handle.param("mode", Mode, std::string());
  if (Mode.compare(S) == 0)
    Out.publish(std_msgs::Number());
}
