// The exposing statement is ros::ServiceClient::call. The server, in the same
// node on its own queue, publishes what it is asked.
#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <std_msgs/Bool.h>
#include <std_msgs/Float64.h>
#include <std_srvs/SetBool.h>

class PumpServer {
public:
  PumpServer() : spinner_(1, &queue_) {
    nh_.setCallbackQueue(&queue_);
    pub_ = nh_.advertise<std_msgs::Bool>("output", 1000);
    server_ = nh_.advertiseService("exp_service_client/pump", &PumpServer::pump,
                                   this);
    spinner_.start();
  }

private:
  bool pump(std_srvs::SetBool::Request &request,
            std_srvs::SetBool::Response &response) {
    std_msgs::Bool state;
    state.data = request.data;
    pub_.publish(state);
    response.success = true;
    return true;
  }

  ros::CallbackQueue queue_;
  ros::NodeHandle nh_;
  ros::Publisher pub_;
  ros::ServiceServer server_;
  ros::AsyncSpinner spinner_;
};

class LevelControl {
public:
  LevelControl() {
    nh_.param("full", full_, 6.0);
    nh_.param("empty", empty_, -6.0);
    client_ = nh_.serviceClient<std_srvs::SetBool>("exp_service_client/pump");
    sub_ = nh_.subscribe("input", 1000, &LevelControl::level, this);
  }

private:
  void level(const std_msgs::Float64::ConstPtr &msg) {
    std_srvs::SetBool pump;
    if (msg->data > full_) {
      pump.request.data = false;
      client_.call(pump);
    } else if (msg->data < empty_) {
      pump.request.data = true;
      if (!client_.call(pump))
        ROS_ERROR("no pump");
    }
  }

  ros::NodeHandle nh_;
  ros::ServiceClient client_;
  ros::Subscriber sub_;
  double full_, empty_;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "exp_service_client");
  PumpServer server;
  LevelControl control;
  ros::spin();
  return 0;
}
