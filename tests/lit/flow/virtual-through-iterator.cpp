// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// begin(), which stays a call, returns an object with a pointer in it: the
// class of the object says what the pointer leads to.
// CHECK: comparisons of {{.*}}: 1
// CHECK-NEXT: parameter 'limit' relation > as x
#include <memory>
#include <ros/ros.h>
#include <vector>

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

int main(int Count, char **) {
  ros::NodeHandle Handle;
  ros::Publisher Out = Handle.advertise<std_msgs::Number>("out", 1);
  std::vector<std::shared_ptr<Filter>> Chain;
  auto First = std::make_shared<Low>();
  Handle.param("limit", First->Limit, 1.0);
  Chain.push_back(First);
  Chain.push_back(std::make_shared<All>());
  for (auto &One : Chain)
    if (!One->accepts(Count))
      return 1;
  Out.publish(std_msgs::Number());
}
