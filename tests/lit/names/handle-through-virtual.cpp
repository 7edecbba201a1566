// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-param-calls>' %t.o | FileCheck %s
//
// A handle that a virtual call passes on keeps its namespace in the functions
// that the call may enter.
#include <ros/ros.h>

class Base {
public:
  virtual ~Base() {}
  void init() {
    ros::NodeHandle Handle("~/layer");
    setUp(Handle);
  }
  // CHECK-DAG: ~layer/other
  virtual void setUp(ros::NodeHandle &Handle) {
    Handle.param("other", Other, 1.0);
  }
  double Other = 0;
};

class Derived : public Base {
public:
  // CHECK-DAG: ~layer/limit
  void setUp(ros::NodeHandle &Handle) override {
    Handle.param("limit", Limit, 1.0);
  }
  double Limit = 0;
};

Base *make() {
  Derived *D = new Derived;
  D->init();
  return D;
}
