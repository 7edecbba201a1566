// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes=tpc -tpc-max-local-copies=4 -tpc-static-info=%t.json %t.o
// RUN: %python %inputs/show.py spots %t.json | FileCheck %s
//
// A value in an object that is copied more often than is followed is not
// "read by nothing here".
#include <ros/ros.h>

struct Settings {
  double Most, Least, Step;
};

class Owner {
public:
  void change(const Settings &New) { Used = New; }
  Settings current() { return Used; }

private:
  Settings Used;
};

double distance();

#define FOUR(X) (X + X + X + X)
double sum(Owner &From) { return FOUR(FOUR(From.current().Least)); }

bool isNear(Owner &From, double Value) {
  return Value <= From.current().Most;
}

void read(ros::NodeHandle &Handle, Owner &Into) {
  Settings New;
  // CHECK: many_targets
  // CHECK-NOT: unread
  Handle.param("most", New.Most, 1.0);
  Into.change(New);
}

int main() {
  ros::NodeHandle Handle;
  ros::Publisher Out;
  Owner Limits;
  read(Handle, Limits);
  std_msgs::Number Message;
  Message.data = sum(Limits);
  if (isNear(Limits, distance()))
    Out.publish(Message);
}
