// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// A function without a body does not write what it takes as `const &` or as
// pointer to const, nor the object of a const method: whether it is called
// decides nothing about the message.
// What it takes as `&`, and what a pointer that it takes leads to, it can write.
#include <memory>
#include <ros/ros.h>

namespace library {
struct Recorder {
  void note(const std_msgs::Number &Message);
  static void dump(int Level, const std_msgs::Number *Message);
};
struct Text : std_msgs::Number {
  void print() const;
  void trim();
};
void show(const std_msgs::Number &Message, double Scale);
void fill(std_msgs::Number &Message);
void complete(const std::shared_ptr<std_msgs::Number> &Message);
} // namespace library

// CHECK: comparisons of {{.*}}: 3
void input(ros::Publisher &Out, library::Recorder &R, double V,
           double Limits[7]) {
  std_msgs::Number Message;
  Message.data = V;
  if (V > Limits[0])
    library::show(Message, 1.0);
  if (V > Limits[1])
    R.note(Message);
  if (V > Limits[2])
    library::Recorder::dump(1, &Message);
  // CHECK-DAG: 'filled' relation > {{.*}} at [[#@LINE+1]]:9
  if (V > Limits[3])
    library::fill(Message);
  Out.publish(Message);
  auto Shared = std::make_shared<std_msgs::Number>();
  // CHECK-DAG: 'completed' relation > {{.*}} at [[#@LINE+1]]:9
  if (V > Limits[4])
    library::complete(Shared);
  Out.publish(*Shared);
  library::Text Text;
  Text.data = V;
  if (V > Limits[5])
    Text.print();
  // CHECK-DAG: 'trimmed' relation > {{.*}} at [[#@LINE+1]]:9
  if (V > Limits[6])
    Text.trim();
  Out.publish(Text);
}

void run(ros::NodeHandle &Handle, ros::Publisher &Out, library::Recorder &R,
         double V) {
  double Limits[7];
  Handle.param("shown", Limits[0], 1.0);
  Handle.param("noted", Limits[1], 1.0);
  Handle.param("dumped", Limits[2], 1.0);
  Handle.param("filled", Limits[3], 1.0);
  Handle.param("completed", Limits[4], 1.0);
  Handle.param("printed", Limits[5], 1.0);
  Handle.param("trimmed", Limits[6], 1.0);
  input(Out, R, V, Limits);
}
