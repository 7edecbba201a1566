// The exposing statement is an action client's sendGoal. The server, in the
// same node, publishes the goals that it gets.
#include <actionlib/TestAction.h>
#include <actionlib/client/simple_action_client.h>
#include <actionlib/server/simple_action_server.h>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <ros/ros.h>
#include <std_msgs/Float64.h>
#include <std_msgs/Int32.h>
#include <thread>

using Client = actionlib::SimpleActionClient<actionlib::TestAction>;
using Server = actionlib::SimpleActionServer<actionlib::TestAction>;

class DockServer {
public:
  explicit DockServer(ros::NodeHandle &nh)
      : pub_(nh.advertise<std_msgs::Int32>("output", 1000)),
        server_(
            nh, "exp_action_client_dock",
            [this](const actionlib::TestGoalConstPtr &goal) { dock(*goal); },
            false) {
    server_.start();
  }

private:
  void dock(const actionlib::TestGoal &goal) {
    std_msgs::Int32 station;
    station.data = goal.goal;
    pub_.publish(station);
    server_.setSucceeded();
  }

  ros::Publisher pub_;
  Server server_;
};

class DockClient {
public:
  explicit DockClient(ros::NodeHandle &nh)
      : client_("exp_action_client_dock", true) {
    nh.param("dock_below", dock_below_, -3.0);
    sub_ = nh.subscribe("input", 1000, &DockClient::battery, this);
    worker_ = std::thread(&DockClient::run, this);
  }
  ~DockClient() { worker_.join(); }

private:
  void battery(const std_msgs::Float64::ConstPtr &level) {
    std::lock_guard<std::mutex> lock(mutex_);
    levels_.push_back(level->data);
    arrived_.notify_one();
  }

  void run() {
    client_.waitForServer();
    while (ros::ok()) {
      std::unique_lock<std::mutex> lock(mutex_);
      arrived_.wait_for(lock, std::chrono::milliseconds(10));
      while (!levels_.empty()) {
        const double level = levels_.front();
        levels_.pop_front();
        if (level < dock_below_) {
          actionlib::TestGoal goal;
          goal.goal = static_cast<int>(level);
          lock.unlock();
          client_.sendGoal(goal);
          client_.waitForResult();
          lock.lock();
        }
      }
    }
  }

  Client client_;
  ros::Subscriber sub_;
  double dock_below_;
  std::mutex mutex_;
  std::condition_variable arrived_;
  std::deque<double> levels_;
  std::thread worker_;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "exp_action_client");
  ros::NodeHandle nh;
  DockServer server(nh);
  DockClient client(nh);
  ros::spin();
  return 0;
}
