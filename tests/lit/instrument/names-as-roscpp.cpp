// RUN: %compile -O0 %s -o %t.small.o
// RUN: llvm-nm -j --undefined-only %t.small.o | grep -E 'NodeHandle(8getParam|14getParamCached|11searchParam|C1|D1|aS)|3ros5(param|names)' | sort > %t.small
// RUN: %compile -O0 -DREAL %s -o %t.real.o
// RUN: llvm-nm -j --undefined-only %t.real.o | sort > %t.real
// RUN: comm -23 %t.small %t.real | count 0
// RUN: llvm-nm -C %t.small.o | grep -E 'ros::(NodeHandle|Publisher|ServiceClient)::(param|publish|call|advertise|serviceClient)<|ros::param::param<' | sed -E 's/.* W //' | sort > %t.templates
// RUN: llvm-nm -C %t.real.o | sed -E 's/.* W //' | sort > %t.real-templates
// RUN: comm -23 %t.templates %t.real-templates | count 0
// RUN: FileCheck %s --input-file=%t.templates
//
// The functions that the tests' small ros.h declares have the mangled names
// of roscpp's.
// CHECK-DAG: ros::NodeHandle::param<double>(
// CHECK-DAG: double ros::NodeHandle::param<double>(
// CHECK-DAG: double ros::param::param<double>(
// CHECK-DAG: bool ros::param::param<double>(
// CHECK-DAG: ros::Publisher::publish<{{.*}}>(
#ifdef REAL
#include "/usr/include/ros/ros.h"
#include "/usr/include/std_msgs/Float64.h"
using Message = std_msgs::Float64;
#else
#include <ros/ros.h>
namespace std_msgs {
template <typename A> struct Float64_ {
  double data;
};
} // namespace std_msgs
using Message = std_msgs::Float64_<std::allocator<void>>;
#endif

int main() {
  ros::NodeHandle Handle("~");
  double D;
  int I;
  bool B;
  Handle.getParam("d", D);
  Handle.getParam("i", I);
  Handle.getParam("b", B);
  Handle.param("d", D, 1.0);
  std::string Key;
  Handle.getParam("s", Key);
  Handle.getParamCached("d", D);
  Handle.searchParam("d", Key);
  D = Handle.param("d", 1.0);
  ros::NodeHandle Below(Handle, "below"), Copy(Below);
  Copy = Handle;
  Key = ros::names::append("a", "b");
  ros::param::get("d", D);
  ros::param::getCached("d", D);
  ros::param::param("d", D, 1.0);
  D = ros::param::param("d", 1.0);
  ros::Publisher Out = Handle.advertise<Message>("out", 1);
  Out.publish(Message());
}
