// RUN: %compile -O0 %s -o %t.0.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-param-calls>' %t.0.o | FileCheck %s
// RUN: %compile -O2 %s -o %t.2.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-param-calls>' %t.2.o | FileCheck %s
//
// Names that are composed of constants are known completely; of other names,
// the constant parts are.
#include <ros/ros.h>

static const std::string Prefix = "arm/";
constexpr char Limit[] = "limit";
static const char *const Tail = "/tail";
static const std::string Whole = Prefix + Limit;

static std::string key(int Wheel) {
  return "wheel_" + std::to_string(Wheel) + "/limit";
}

class Node {
public:
  explicit Node(ros::NodeHandle &Handle) : Group("group/") {
    Later = "later";
    // CHECK-DAG: 'group/limit' double default {{.*}} at [[#@LINE+1]]:
    Handle.param(Group + Limit, A, 1.0);
    // CHECK-DAG: 'later' double default {{.*}} at [[#@LINE+1]]:
    Handle.param(Later, A, 1.0);
    Handle.getParam("group", Read);
    // CHECK-DAG: '<dynamic>/limit' double default {{.*}} at [[#@LINE+1]]:
    Handle.param(Read + "/limit", A, 1.0);
  }
  std::string Group, Later, Read;
  double A;
};

void load(ros::NodeHandle &Handle, double &A, int Wheel) {
  // CHECK-DAG: 'arm/limit' double default {{.*}} at [[#@LINE+1]]:
  Handle.param(Prefix + Limit, A, 1.0);
  // CHECK-DAG: 'arm/limit' double default {{.*}} at [[#@LINE+1]]:
  Handle.param(Whole, A, 1.0);
  // CHECK-DAG: 'limit/tail' double default {{.*}} at [[#@LINE+1]]:
  Handle.param(std::string(Limit) + Tail, A, 1.0);
  // CHECK-DAG: 'arm/joint/x' double default {{.*}} at [[#@LINE+1]]:
  Handle.param(Prefix + std::string("joint") + "/" + 'x', A, 1.0);
  std::string Name = "a";
  Name += "b";
  Name.append(Limit);
  Name.push_back('c');
  // CHECK-DAG: 'ablimitc' double default {{.*}} at [[#@LINE+1]]:
  Handle.param(Name, A, 1.0);
  // CHECK-DAG: 'joint3' double default {{.*}} at [[#@LINE+1]]:
  Handle.param("joint" + std::to_string(3), A, 1.0);
  // CHECK-DAG: 'wheel_<dynamic>/limit' double default {{.*}} at [[#@LINE+1]]:
  Handle.param(key(Wheel), A, 1.0);
  // CHECK-DAG: 'left/right' double default {{.*}} at [[#@LINE+1]]:
  Handle.param(ros::names::append("left", "right"), A, 1.0);
  std::string Found;
  if (Handle.searchParam("searched", Found))
    // CHECK-DAG: 'searched' double default {{.*}} at [[#@LINE+1]]:
    Handle.getParam(Found, A);
  const char *Either = Wheel ? "one" : "two";
  // CHECK-DAG: '<dynamic>' double default {{.*}} at [[#@LINE+1]]:
  Handle.param(Either, A, 1.0);
  for (const char *Joint : {"first", "second"})
    // CHECK-DAG: '<dynamic>' double default {{.*}} at [[#@LINE+1]]:
    Handle.param(Joint, A, 1.0);
}

int main() {
  ros::NodeHandle Handle;
  Node N(Handle);
  load(Handle, N.A, 1);
  load(Handle, N.A, 2);
}
