// REQUIRES: ros1-headers
// RUN: %compile-real -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' %t.o | FileCheck %s
//
// A lock of a library throws if the mutex is broken, on a path with branches of
// its own. That is no decision about what stands behind the lock, so what
// controls one lock has no part in what is published behind another. A throw in
// user code is one.
#include <boost/thread/locks.hpp>
#include <boost/thread/mutex.hpp>
#include <boost/thread/recursive_mutex.hpp>
#include <ros/ros.h>
#include <std_msgs/Float64.h>

struct Node {
  boost::mutex Mutex;
  boost::recursive_mutex Recursive;
  ros::Publisher Out;
  double Locking, Throwing;
  int Seen = 0;

  explicit Node(ros::NodeHandle &Handle) {
    Handle.param("locking", Locking, 1.0);
    Handle.param("throwing", Throwing, 1.0);
    Out = Handle.advertise<std_msgs::Float64>("out", 1);
  }

  // CHECK: comparisons of {{.*}}: 1
  // CHECK-NEXT: 'throwing' {{.*}} at [[#@LINE+11]]:
  void locks(double V) {
    if (V > Locking) {
      boost::unique_lock<boost::recursive_mutex> First(Recursive);
      boost::lock_guard<boost::mutex> Second(Mutex);
      ++Seen;
    }
  }

  void check(double V) {
    boost::mutex::scoped_lock Lock(Mutex);
    if (V > Throwing)
      throw 1;
  }

  void publishes(double V) {
    check(V);
    boost::unique_lock<boost::recursive_mutex> First(Recursive);
    boost::mutex::scoped_lock Second(Mutex);
    Out.publish(std_msgs::Float64());
  }
};

void run(ros::NodeHandle &Handle, double V) {
  Node Only(Handle);
  Only.locks(V);
  Only.publishes(V);
}
