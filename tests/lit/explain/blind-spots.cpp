// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes=tpc -tpc-static-info=%t.json %t.o
// RUN: %python %inputs/show.py spots %t.json | FileCheck %s --match-full-lines
//
// Where the analysis has blind spots: each place once, by kind.
#include <ros/ros.h>

#include <functional>

// CHECK: 9 blind spots, 9 listed

void show(double Value);
void keep(bool Outcome);
double **anywhere();
extern void (*Hook)();

struct Message {
  double Limit;
};

void step(ros::NodeHandle &Handle, const std::string &Name, double Value,
          const std::function<void()> &Callback) {
  double Gain, Shown, Kept, Hidden, Sent, Own;
  Handle.param("gain", Gain, 0.5);
  Handle.param("shown", Shown, 0.5);
  Handle.param("kept", Kept, 0.5);
  Handle.param("hidden", Hidden, 0.5);
  Handle.param("sent", Sent, 0.5);
  // CHECK-NEXT: lost_value gain [[#@LINE+1]] step: mixed with another variable, and compared with a constant
  if (Gain * Value > 10)
    keep(true);
  // CHECK-NEXT: lost_value shown [[#@LINE+1]] step: handed to show(), which is not analysed
  show(Shown);
  // CHECK-NEXT: lost_outcome kept [[#@LINE+1]] step: handed to keep(), which is not analysed
  keep(Value > Kept);
  // CHECK-NEXT: unknown_pointer hidden [[#@LINE+1]] step: stored through a pointer to an unknown place
  **anywhere() = Hidden;
  Message *Out = new Message;
  // CHECK-NEXT: unread sent [[#@LINE+1]] step: stored into Message::Limit, and nothing here reads it
  Out->Limit = Sent;
  // CHECK-NEXT: unread <dynamic>limit [[#@LINE+2]] step: stored into Own, and nothing here reads it
  // CHECK-NEXT: dynamic_name None [[#@LINE+1]] step: reads a parameter whose name is not constant
  Handle.getParam(Name + "limit", Own);
  // CHECK-NEXT: indirect_call None [[#@LINE+1]] step: calls a function that is not known
  Hook();
  // CHECK-NEXT: indirect_call None [[#@LINE+1]] step: calls a function that is not known
  Callback();
}
