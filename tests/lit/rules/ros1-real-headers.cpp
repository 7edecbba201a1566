// REQUIRES: ros1-headers
// RUN: %compile-real -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-param-calls>,print<tpc-extern-calls>' %t.o | FileCheck %s
//
// Each row for an installed package matches the real headers: all forms and
// types of the reads, and the statements of actionlib, tf and tf2.
#include <actionlib/TestAction.h>
#include <actionlib/client/simple_action_client.h>
#include <actionlib/server/action_server.h>
#include <actionlib/server/simple_action_server.h>
#include <ros/ros.h>
#include <std_msgs/Float64.h>
#include <std_srvs/Empty.h>
#include <tf/transform_broadcaster.h>
#include <tf2_ros/static_transform_broadcaster.h>
#include <tf2_ros/transform_broadcaster.h>

using Server = actionlib::ActionServer<actionlib::TestAction>;

template <typename T>
__attribute__((noinline)) void forms(const ros::NodeHandle &Handle, T Default) {
  T V;
  Handle.param("a", V, Default);
  V = Handle.param("b", Default);
  Handle.getParam("c", V);
  ros::param::get("d", V);
  ros::param::getCached("e", V);
  Handle.getParamCached("f", V);
}

// CHECK-DAG: ros::NodeHandle::param '~a' double default 1
// CHECK-DAG: ros::NodeHandle::param '~b' double default 1
// CHECK-DAG: ros::NodeHandle::getParam '~c' double default null
// CHECK-DAG: ros::param::get 'd' double
// CHECK-DAG: ros::param::getCached 'e' double
// CHECK-DAG: ros::NodeHandle::getParamCached '~f' double
// CHECK-DAG: ros::NodeHandle::param '~a' float default 2
// CHECK-DAG: ros::NodeHandle::getParamCached '~f' float
// CHECK-DAG: ros::NodeHandle::param '~a' int default 3
// CHECK-DAG: ros::param::getCached 'e' int
// CHECK-DAG: ros::NodeHandle::param '~a' bool default true
// CHECK-DAG: ros::param::get 'd' bool
static void reads() {
  ros::NodeHandle Private("~");
  forms(Private, 1.0);
  forms(Private, 2.0F);
  forms(Private, 3);
  forms(Private, true);
}

static void statements(Server::GoalHandle Goal, bool Way) {
  ros::NodeHandle Handle;
  // CHECK-DAG: ros::Publisher::publish topic 'out'
  ros::Publisher Out = Handle.advertise<std_msgs::Float64>("out", 1);
  Out.publish(std_msgs::Float64());
  std_srvs::Empty Service;
  // CHECK-DAG: ros::service::call topic 'free'
  ros::service::call("free", Service);
  // CHECK-DAG: ros::ServiceClient::call topic 'client'
  ros::ServiceClient Client = Handle.serviceClient<std_srvs::Empty>("client");
  Client.call(Service);
  // CHECK-DAG: actionlib::ServerGoalHandle::setAccepted
  Goal.setAccepted();
  // CHECK-DAG: actionlib::ServerGoalHandle::setSucceeded
  // CHECK-DAG: actionlib::ServerGoalHandle::setAborted
  // CHECK-DAG: actionlib::ServerGoalHandle::setCanceled
  // CHECK-DAG: actionlib::ServerGoalHandle::setRejected
  // CHECK-DAG: actionlib::ServerGoalHandle::publishFeedback
  Goal.publishFeedback(actionlib::TestFeedback());
  Way ? Goal.setSucceeded() : Goal.setAborted();
  Way ? Goal.setCanceled() : Goal.setRejected();
  actionlib::SimpleActionServer<actionlib::TestAction> Simple("do", false);
  // CHECK-DAG: actionlib::SimpleActionServer::setSucceeded
  // CHECK-DAG: actionlib::SimpleActionServer::setAborted
  // CHECK-DAG: actionlib::SimpleActionServer::setPreempted
  // CHECK-DAG: actionlib::SimpleActionServer::publishFeedback
  Simple.publishFeedback(actionlib::TestFeedback());
  Way ? Simple.setSucceeded() : Simple.setAborted();
  Simple.setPreempted();
  actionlib::SimpleActionClient<actionlib::TestAction> Asks("do");
  // CHECK-DAG: actionlib::SimpleActionClient::sendGoal
  // CHECK-DAG: actionlib::SimpleActionClient::sendGoalAndWait
  // CHECK-DAG: actionlib::SimpleActionClient::cancelGoal
  Asks.sendGoal(actionlib::TestGoal());
  Asks.sendGoalAndWait(actionlib::TestGoal());
  Asks.cancelGoal();
  // CHECK-DAG: tf::TransformBroadcaster::sendTransform
  tf::TransformBroadcaster().sendTransform(tf::StampedTransform());
  // CHECK-DAG: tf2_ros::TransformBroadcaster::sendTransform
  tf2_ros::TransformBroadcaster().sendTransform(
      geometry_msgs::TransformStamped());
  // CHECK-DAG: tf2_ros::StaticTransformBroadcaster::sendTransform
  tf2_ros::StaticTransformBroadcaster().sendTransform(
      geometry_msgs::TransformStamped());
}

int main(int Argc, char **) {
  reads();
  statements({}, Argc > 1);
}
