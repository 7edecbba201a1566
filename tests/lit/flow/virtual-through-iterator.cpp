// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// A function that stays a call returns an iterator, an object with a pointer in
// it: what that leads to is known by the iterator's class.
// CHECK: comparisons of {{.*}}: 1
// CHECK-NEXT: parameter 'limit' relation > as x
#include <ros/ros.h>

struct Filter {
  virtual bool accepts(double Value) = 0;
};

struct Low : Filter {
  double Limit = 0;
  bool accepts(double Value) override { return !(Value > Limit); }
};

struct All : Filter {
  bool accepts(double) override { return true; }
};

struct Iterator {
  Filter **At;
  Filter &operator*() const { return **At; }
  bool operator!=(const Iterator &Other) const { return At != Other.At; }
  void operator++() { ++At; }
};

struct Chain {
  Filter *Filters[2];
  __attribute__((noinline)) Iterator begin() { return {Filters}; }
  __attribute__((noinline)) Iterator end() { return {Filters + 2}; }
};

int main(int Count, char **) {
  ros::NodeHandle Handle;
  ros::Publisher Out = Handle.advertise<std_msgs::Number>("out", 1);
  Low First;
  All Second;
  Handle.param("limit", First.Limit, 1.0);
  Chain Of{{&First, &Second}};
  for (Filter &One : Of)
    if (!One.accepts(Count))
      return 1;
  Out.publish(std_msgs::Number());
}
