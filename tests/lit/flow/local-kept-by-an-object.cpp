// RUN: %compile -O2 %s -o %t.2.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.2.o | FileCheck %s
// RUN: %compile -O0 %s -o %t.0.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.0.o | FileCheck %s
//
// An object that got the address of a local writes and reads the local,
// although the local is not passed to it again.
#include <ros/ros.h>

static ros::NodeHandle Handle;
static ros::Publisher Out;
bool ok();

struct Reader {
  double &To;
  explicit Reader(double &Of) : To(Of) {}
  void read() { Handle.param("limit", To, 1.0); }
};

struct Writer {
  double &Of;
  explicit Writer(double &Value) : Of(Value) {}
  void emit() {
    std_msgs::Number Message;
    Message.data = Of;
    Out.publish(Message);
  }
};

// CHECK: comparisons of {{.*}}: 3
void once(double V) {
  double Limit;
  Reader Own(Limit);
  Limit = 0;
  Own.read();
  // CHECK-DAG: 'limit' {{.*}} at [[#@LINE+1]]:9
  if (V > Limit)
    Out.publish(std_msgs::Number());
}

void again(double V) {
  double Limit;
  Reader Own(Limit);
  while (ok()) {
    Limit = 0;
    Own.read();
    // CHECK-DAG: 'limit' {{.*}} at [[#@LINE+1]]:11
    if (V > Limit)
      Out.publish(std_msgs::Number());
  }
}

void shown(double V, double Level) {
  Handle.param("level", Level, 1.0);
  double Command = 0;
  Writer Own(Command);
  // CHECK-DAG: 'level' {{.*}} at [[#@LINE+1]]:15
  Command = V > Level ? 1 : 0;
  Own.emit();
  Command = 0;
}
