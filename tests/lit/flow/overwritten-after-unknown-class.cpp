// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// If only the library describes the class of an object, its contents are unknown
// here: it may store functions. And not every operator of a library is operator new.
#include <functional>
#include <ros/ros.h>

struct Timer {
  Timer();
  virtual ~Timer();
  std::function<void()> Task;
};
void run(Timer &);

struct Base {
  virtual ~Base();
  virtual void update();
};
bool operator!=(const Base &, const Base &);

static ros::Publisher Out;
static double Limit, Level, Command, Order;

struct Sender : Base {
  void update() override {
    std_msgs::Number Message;
    Message.data = Order;
    Out.publish(Message);
  }
};

static void emit() {
  std_msgs::Number Message;
  Message.data = Command;
  Out.publish(Message);
}

// CHECK: comparisons of {{.*}}: 2
void withTask(double V) {
  Timer Own;
  Own.Task = emit;
  // CHECK-DAG: 'limit' {{.*}} at [[#@LINE+1]]:15
  Command = V > Limit ? 1 : 0;
  run(Own);
  Command = 0;
}

void compared(double V) {
  static Sender Own;
  // CHECK-DAG: 'level' {{.*}} at [[#@LINE+1]]:13
  Order = V > Level ? 1 : 0;
  bool Differs = Own != Own;
  Order = Differs;
}

void start(ros::NodeHandle &Handle, double V) {
  Handle.param("limit", Limit, 1.0);
  Handle.param("level", Level, 1.0);
  withTask(V);
  compared(V);
}
