// RUN: %compile -O2 %s -o %t.2.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.2.o | FileCheck %s
// RUN: %compile -O0 %s -o %t.0.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.0.o | FileCheck %s
//
// A method returns settings by value, as it does to lock them only while they
// are copied. Each caller has a copy of its own, however many there are, and
// hands it on. A twin is read into
// settings of their own.
#include <ros/ros.h>

struct Settings {
  double Most, Least, Step;
};
struct Lock {
  Lock();
  ~Lock();
};

class Owner {
public:
  void change(Settings &New) {
    Lock Here;
    Used = Settings(New);
  }
  Settings current() {
    Lock Here;
    return Used;
  }

private:
  Settings Used;
};

double distance();

#define FOUR(X) (X + X + X + X)
double sum(Owner &From) { return FOUR(FOUR(From.current().Least)); }

// CHECK: comparisons of {{.*}}: 2
bool isAbove(const Settings *Limits, double Value) {
  // CHECK-DAG: parameter 'most' relation > {{.*}} at [[#@LINE+1]]:16
  return Value > Limits->Most;
}

bool isPassed(Owner &From, double Value) {
  Settings Own = From.current();
  return isAbove(&Own, Value);
}

bool isNear(Owner &From, double Value) {
  // CHECK-DAG: parameter 'most' relation <= {{.*}} at [[#@LINE+1]]:16
  return Value <= From.current().Most;
}

void read(ros::NodeHandle &Handle, Owner &Into) {
  Settings New;
  New.Most = New.Least = 0;
  Handle.param("most", New.Most, 1.0);
  Settings Unused;
  Handle.param("twin", Unused.Most, 1.0);
  Into.change(New);
}

int main() {
  ros::NodeHandle Handle;
  ros::Publisher Out;
  Owner Limits;
  read(Handle, Limits);
  std_msgs::Number Message;
  Message.data = sum(Limits);
  if (isPassed(Limits, distance()))
    Out.publish(Message);
  if (isNear(Limits, distance()))
    Out.publish(Message);
}
