// RUN: %compile -O0 %s -o %t.0.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-param-calls>' %t.0.o | FileCheck %s
// RUN: %compile -O2 %s -o %t.2.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-param-calls>' %t.2.o | FileCheck %s
//
// A name, a handle and a default that are arguments of a helper are those of
// each call: in a template, through two helpers, in a method.
#include <ros/ros.h>

template <typename T>
void load(const ros::NodeHandle &Handle, const std::string &Name, T &Value,
          const T &Default) {
  Handle.param(Name, Value, Default);
}

static void loadGroup(ros::NodeHandle Handle, const std::string &Group,
                      double &Kp, double &Ki) {
  load(Handle, Group + "/kp", Kp, 0.5);
  load(Handle, Group + "/ki", Ki, 0.25);
}

class Loader {
public:
  explicit Loader(const ros::NodeHandle &Handle) : Handle(Handle) {}
  double get(std::string Name, double Default) {
    double Value;
    Handle.param<double>(Name, Value, Default);
    return Value;
  }

private:
  ros::NodeHandle Handle;
};

double A, B, C, D;
int I;

// CHECK: parameter reads of {{.*}}: 9
// CHECK-DAG: '~roll/kp' double default 0.5
// CHECK-DAG: '~roll/ki' double default 0.25
// CHECK-DAG: 'pitch/kp' double default 0.5
// CHECK-DAG: 'pitch/ki' double default 0.25
// CHECK-DAG: 'single' int default 7
// CHECK-DAG: '~speed' double default 3
// CHECK-DAG: '~height' double default 4
// CHECK-DAG: '<dynamic>' double default 1
// CHECK-DAG: 'single' double default 2
int main(int, char **Argv) {
  ros::NodeHandle Plain, Private("~");
  loadGroup(Private, "roll", A, B);
  loadGroup(Plain, "pitch", C, D);
  load(Plain, "single", I, 7);
  load(Plain, Argv[1], A, 1.0);
  load(Plain, "single", A, 2.0);
  Loader L(Private);
  A = L.get("speed", 3);
  B = L.get("height", 4);
}
