// RUN: %native -c %inputs/ros.cpp -o %t.ros.o
// RUN: %compile -O2 %s -o %t.o
// RUN: %link -O2 -Wl,-mllvm,-tpc-static-info=%t.json %t.o %t.ros.o -o %t
// RUN: FileCheck %s --input-file=%t.json
//
// The linker merges classes with the same fields into one LLVM type; they stay two.
#include <ros/ros.h>

class Limiter {
public:
  void load(ros::NodeHandle &Handle) { Handle.param("most", Most, 2.0); }
  // CHECK: "comparisons": 1,
  bool over(double V) const { return V > Most; }

private:
  double Most = 0, Last = 0;
};

class Point {
public:
  void set(double To) { X = To; }
  bool before(double V) const { return V > X; }

private:
  double X = 0, Y = 0;
};

int main(int Argc, char **) {
  ros::NodeHandle Handle;
  Limiter L;
  Point P;
  L.load(Handle);
  P.set(Argc);
  ros::Publisher Out;
  if (L.over(Argc))
    Out.publish(std_msgs::Number());
  if (P.before(Argc))
    Out.publish(std_msgs::Number());
}
