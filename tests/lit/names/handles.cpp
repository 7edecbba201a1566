// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-param-calls>' %t.o | FileCheck %s
//
// The constant namespace of a node handle is put before the name, wherever the
// handle is stored and however it got there.
#include <ros/ros.h>

#include <memory>

class Node {
public:
  Node(const ros::NodeHandle &Handle, ros::NodeHandle ByValue)
      : Private("~"), Copied(Handle), Value(ByValue), Reference(Handle),
        Pointer(new ros::NodeHandle("pointed")),
        Owned(std::make_unique<ros::NodeHandle>("owned")) {
    Assigned = ros::NodeHandle("assigned");
    // CHECK-DAG: '~limit' double default {{.*}} at [[#@LINE+1]]:
    Private.param("limit", A, 1.0);
    // CHECK-DAG: 'given/limit' double default {{.*}} at [[#@LINE+1]]:
    Copied.param("limit", A, 1.0);
    // CHECK-DAG: 'value/limit' double default {{.*}} at [[#@LINE+1]]:
    Value.param("limit", A, 1.0);
    // CHECK-DAG: 'assigned/limit' double default {{.*}} at [[#@LINE+1]]:
    Assigned.param("limit", A, 1.0);
  }
  void load() {
    // CHECK-DAG: '~later' double default {{.*}} at [[#@LINE+1]]:
    Private.param("later", A, 1.0);
    // CHECK-DAG: 'given/by_reference' double default {{.*}} at [[#@LINE+1]]:
    Reference.param("by_reference", A, 1.0);
    // CHECK-DAG: 'pointed/limit' double default {{.*}} at [[#@LINE+1]]:
    Pointer->param("limit", A, 1.0);
    // CHECK-DAG: 'owned/limit' double default {{.*}} at [[#@LINE+1]]:
    Owned->param("limit", A, 1.0);
    // CHECK-DAG: '/absolute' double default {{.*}} at [[#@LINE+1]]:
    Private.param("/absolute", A, 1.0);
  }
  ros::NodeHandle Private, Copied, Value, Assigned;
  const ros::NodeHandle &Reference;
  ros::NodeHandle *Pointer;
  std::unique_ptr<ros::NodeHandle> Owned;
  double A;
};

int main(int Argc, char **Argv) {
  ros::NodeHandle Plain;
  ros::NodeHandle Given("given");
  ros::NodeHandle Below(Given, "below");
  ros::NodeHandle PrivateBelow(ros::NodeHandle("~"), "sub");
  ros::NodeHandle Slashed("~/sub");
  ros::NodeHandle Computed(Argv[0]);
  Node N(Given, ros::NodeHandle("value"));
  double A;
  // CHECK-DAG: 'bare' double default {{.*}} at [[#@LINE+1]]:
  Plain.param("bare", A, 1.0);
  // CHECK-DAG: 'given/below/limit' double default {{.*}} at [[#@LINE+1]]:
  Below.param("limit", A, 1.0);
  // CHECK-DAG: '~sub/limit' double default {{.*}} at [[#@LINE+1]]:
  PrivateBelow.param("limit", A, 1.0);
  // CHECK-DAG: '~sub/limit' double default {{.*}} at [[#@LINE+1]]:
  Slashed.param("limit", A, 1.0);
  // CHECK-DAG: '<dynamic>/limit' double default {{.*}} at [[#@LINE+1]]:
  Computed.param("limit", A, 1.0);
  // CHECK-DAG: '~free' double default {{.*}} at [[#@LINE+1]]:
  ros::param::param("~free", A, 1.0);
  // CHECK-DAG: '<dynamic>/either' double default {{.*}} at [[#@LINE+1]]:
  (Argc > 1 ? Given : Plain).param("either", A, 1.0);
  N.load();
}
