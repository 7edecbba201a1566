// RUN: %compile -O2 %s -o %t.2.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.2.o | FileCheck %s
// RUN: %compile -O0 %s -o %t.0.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.0.o | FileCheck %s
//
// Members of std::string leave alone what they take as const, whether their
// bodies are in the link unit or not: whether a text is copied, joined, searched
// for or destroyed decides nothing about the message that it is a part of.
#include <ros/ros.h>

struct Text {
  double data = 0;
  std::string name;
};

static std::string Log;

// CHECK: comparisons of {{.*}}: 2
void step(ros::Publisher &Out, const std::string &Given, double V,
          double Limits[7]) {
  Text Message;
  Message.name = Given;
  if (V > Limits[0])
    std::string Copy(Message.name);
  if (V > Limits[1])
    Log = Message.name;
  if (V > Limits[2])
    Log = Message.name + "!" + Message.name;
  if (V > Limits[3])
    Log.insert(0, Message.name);
  if (V > Limits[4] && Log.find(Message.name) != std::string::npos)
    Log.clear();
  // CHECK-DAG: 'appended' relation > {{.*}} at [[#@LINE+1]]:9
  if (V > Limits[5])
    Message.name.append("!");
  // CHECK-DAG: 'moved' relation > {{.*}} at [[#@LINE+1]]:9
  if (V > Limits[6])
    Log = std::move(Message.name);
  Out.publish(Message);
}

void run(ros::NodeHandle &Handle, ros::Publisher &Out, const std::string &Given,
         double V) {
  double Limits[7];
  Handle.param("copied", Limits[0], 1.0);
  Handle.param("assigned", Limits[1], 1.0);
  Handle.param("joined", Limits[2], 1.0);
  Handle.param("inserted", Limits[3], 1.0);
  Handle.param("searched", Limits[4], 1.0);
  Handle.param("appended", Limits[5], 1.0);
  Handle.param("moved", Limits[6], 1.0);
  step(Out, Given, V, Limits);
}
