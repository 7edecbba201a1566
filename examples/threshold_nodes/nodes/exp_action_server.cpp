// The exposing statements are an action server's: publishFeedback, setAborted
// and setSucceeded. A client in the same node sends every value as a goal.
#include <actionlib/TestAction.h>
#include <actionlib/client/simple_action_client.h>
#include <actionlib/server/simple_action_server.h>
#include <deque>
#include <mutex>
#include <ros/ros.h>
#include <std_msgs/Float64.h>
#include <std_msgs/String.h>
#include <thread>

namespace {

class Lift {
  ros::NodeHandle nh_;
  int top_floor_;
  int slow_floor_;
  actionlib::SimpleActionServer<actionlib::TestAction> server_;

  void execute(const actionlib::TestGoalConstPtr &goal) {
    if (goal->goal > top_floor_) {
      server_.setAborted();
      return;
    }
    if (goal->goal < slow_floor_) {
      actionlib::TestFeedback feedback;
      feedback.feedback = goal->goal;
      server_.publishFeedback(feedback);
    }
    actionlib::TestResult result;
    result.result = 2 * goal->goal;
    server_.setSucceeded(result);
  }

public:
  Lift()
      : top_floor_(nh_.param("top_floor", 5)),
        slow_floor_(nh_.param("slow_floor", 0)),
        server_(
            nh_, "exp_action_server_lift",
            [this](const actionlib::TestGoalConstPtr &goal) { execute(goal); },
            false) {
    server_.start();
  }
};

std::mutex mutex;
std::deque<int> floors;

void callLift(ros::Publisher pub) {
  actionlib::SimpleActionClient<actionlib::TestAction> client(
      "exp_action_server_lift", true);
  client.waitForServer();
  while (ros::ok()) {
    std::deque<int> batch;
    {
      std::lock_guard<std::mutex> lock(mutex);
      batch.swap(floors);
    }
    for (int floor : batch) {
      actionlib::TestGoal goal;
      goal.goal = floor;
      client.sendGoal(goal);
      client.waitForResult();
      std_msgs::String state;
      state.data = client.getState().toString();
      pub.publish(state);
    }
    ros::WallDuration(0.01).sleep();
  }
}

void inputCallback(const std_msgs::Float64::ConstPtr &msg) {
  std::lock_guard<std::mutex> lock(mutex);
  floors.push_back(static_cast<int>(msg->data));
}

} // namespace

int main(int argc, char **argv) {
  ros::init(argc, argv, "exp_action_server");
  ros::NodeHandle nh;
  Lift lift;
  ros::Publisher pub = nh.advertise<std_msgs::String>("output", 1000);
  ros::Subscriber sub = nh.subscribe("input", 1000, inputCallback);
  std::thread passenger(callLift, pub);
  ros::spin();
  passenger.join();
  return 0;
}
