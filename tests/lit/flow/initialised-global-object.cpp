// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// A global object with an initial value can have another type in the program
// than its class; its fields are found like those of any other.
#include <ros/ros.h>

#include <memory>

struct Base {
  double Low;
  char Kind;
};
struct Range : Base {
  char On;
  double High;
};

static Range Now = {{1., 'c'}, 1, 2.};
static std::shared_ptr<int> Kept;
static double Limit;

void share(std::shared_ptr<int> &Of);

// CHECK: comparisons of {{.*}}: 2
void copied(ros::Publisher &Out, double V, const Range &Next) {
  // CHECK-DAG: 'limit' {{.*}} at [[#@LINE+1]]:9
  if (V > Limit)
    Now = Next;
  std_msgs::Number Message;
  Message.data = Now.High;
  Out.publish(Message);
}

void handed(ros::Publisher &Out, double V) {
  // CHECK-DAG: 'limit' {{.*}} at [[#@LINE+1]]:9
  if (V > Limit)
    share(Kept);
  if (Kept.use_count() > 1)
    Out.publish(std_msgs::Number());
}

void run(ros::NodeHandle &Handle, ros::Publisher &Out, double V,
         const Range &Next) {
  Handle.param("limit", Limit, 1.0);
  copied(Out, V, Next);
  handed(Out, V);
}
