// REQUIRES: ros1-headers
// RUN: %compile-real -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// A parameter can be a list or a struct: XmlRpcValue, vectors and maps. Its
// elements are compared, and what it says about itself. They are told apart
// from lists that no read has filled.
#include <ros/ros.h>
#include <std_msgs/Float64.h>
#include <xmlrpcpp/XmlRpcValue.h>

static double numberFrom(XmlRpc::XmlRpcValue &Value) {
  // CHECK-DAG: derived 'points' relation == as type(x) {{.*}} at [[#@LINE+1]]:26
  return Value.getType() == XmlRpc::XmlRpcValue::TypeInt
             ? static_cast<int>(Value)
             : static_cast<double>(Value);
}

class Node {
public:
  explicit Node(ros::NodeHandle &Handle) {
    XmlRpc::XmlRpcValue Limits, Own, Points, Layers, Unread;
    Handle.getParam("limits", Limits);
    Low = static_cast<double>(Limits[0]);
    Most = Limits["most"];
    Own[0] = 2.0;
    Fixed = static_cast<double>(Own[0]);
    if (Handle.getParam("points", Points))
      // CHECK-DAG: derived 'points' relation < as size(x) {{.*}} at [[#@LINE+1]]:25
      for (int I = 0; I < Points.size(); ++I) {
        XmlRpc::XmlRpcValue Point = Points[I];
        X = numberFrom(Point[0]);
      }
    Handle.getParam("layers", Layers);
    for (int I = 0; I < 3; ++I) {
      std::string Name = Layers[I]["name"];
      // CHECK-DAG: derived 'layers' relation == as x[] {{.*}} at [[#@LINE+1]]:16
      if (Name == "static")
        Static = true;
    }
    Handle.getParam("unread", Unread);
    Handle.getParam("kept", Kept);
    Handle.getParam("weights", Weights);
    Handle.getParam("gains", Gains);
    Handle.getParam("names", Names);
    Out = Handle.advertise<std_msgs::Float64>("out", 1);
  }
  void step(double Value, unsigned I);

private:
  double Low, Fixed, X;
  int Most;
  bool Static = false;
  XmlRpc::XmlRpcValue Kept;
  std::vector<double> Weights;
  std::map<std::string, double> Gains;
  std::vector<std::string> Names;
  ros::Publisher Out;
};

// CHECK-DAG: comparisons of {{.*}}: 12
void Node::step(double Value, unsigned I) {
  std_msgs::Float64 M;
  // CHECK-DAG: derived 'limits' relation > as x[] distance 1 {{.*}} at [[#@LINE+1]]:13
  if (Value > Low)
    Out.publish(M);
  // CHECK-DAG: derived 'limits' relation > as x[] distance 1 {{.*}} at [[#@LINE+1]]:13
  if (Value > Most)
    Out.publish(M);
  if (Value > Fixed)
    Out.publish(M);
  // CHECK-DAG: derived 'points' relation > as x[] distance 1 {{.*}} at [[#@LINE+1]]:13
  if (Value > X)
    Out.publish(M);
  if (Static)
    Out.publish(M);
  // CHECK-DAG: derived 'kept' relation < as size(x) distance 1 {{.*}} at [[#@LINE+1]]:19
  if (Kept.size() > 2)
    Out.publish(M);
  // CHECK-DAG: derived 'kept' relation != as x[] distance 1 {{.*}} at [[#@LINE+1]]:12
  if (Kept != "")
    Out.publish(M);
  // CHECK-DAG: derived 'kept' relation flag as x[] distance 1 {{.*}} at [[#@LINE+1]]:7
  if (static_cast<bool>(Kept["on"]))
    Out.publish(M);
  // CHECK-DAG: derived 'weights' relation > as 2 * x[] distance 1 {{.*}} at [[#@LINE+1]]:13
  if (Value > 2 * Weights[I])
    Out.publish(M);
  // CHECK-DAG: derived 'gains' relation > as x[] distance 1 {{.*}} at [[#@LINE+1]]:13
  if (Value > Gains["z"])
    Out.publish(M);
  // CHECK-DAG: derived 'names' relation == as x[] distance 1 {{.*}} at [[#@LINE+1]]:21
  if (Names.front() == "loud")
    Out.publish(M);
}

int main(int Count, char **Arguments) {
  ros::init(Count, Arguments, "lists");
  ros::NodeHandle Handle;
  Node N(Handle);
  N.step(Count, Count);
}
