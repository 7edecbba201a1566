// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes=tpc -tpc-static-info=%t.json %t.o
// RUN: %python %inputs/show.py paths %t.json | FileCheck %s --match-full-lines
//
// The path of a parameter from the read to the statement that exposes it, with
// one step for each line of the source.
#include <ros/ros.h>

// CHECK-DAG: far: 8 steps

static bool above(double Value, double Threshold) {
  // CHECK-DAG: far 5: compare [[#@LINE+1]] above: compared: Value > Threshold; outcome returned by above()
  return Value > Threshold;
}

class Camera {
public:
  explicit Camera(ros::NodeHandle &Handle) {
    double Far = 0;
    // CHECK-DAG: far 1: read [[#@LINE+1]] Camera::Camera: far read into Far
    Handle.getParam("far", Far);
    // CHECK-DAG: far 2: store [[#@LINE+1]] Camera::Camera: stored into Camera::limit_
    limit_ = Far;
    Out = Handle.advertise<std_msgs::Number>("pictures", 1);
  }
  void step(double Value) {
    // CHECK-DAG: far 4: pass [[#@LINE+2]] Camera::step: handed to above() as Threshold
    // CHECK-DAG: far 6: decide [[#@LINE+1]] Camera::step: guards the call of take()
    if (above(Value, limit()))
      // CHECK-DAG: far 7: call [[#@LINE+1]] Camera::step: calls take()
      take();
  }

private:
  // CHECK-DAG: far 3: return [[#@LINE+1]] Camera::limit: returned by limit()
  double limit() const { return limit_; }
  // CHECK-DAG: far 8: expose [[#@LINE+1]] Camera::take: published on pictures
  void take() { Out.publish(std_msgs::Number()); }

  ros::Publisher Out;
  double limit_;
};

void run(ros::NodeHandle &Handle) { Camera(Handle).step(2); }
