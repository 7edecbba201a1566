// The exposing statement is ros::service::call; thresholds decide whether it is
// called and what the request holds.
#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <std_msgs/Bool.h>
#include <std_msgs/Float64.h>
#include <std_srvs/SetBool.h>

static ros::Publisher valve_pub;
static double call_above;
static double open_above;

static bool valve(std_srvs::SetBool::Request &request,
                  std_srvs::SetBool::Response &response) {
  std_msgs::Bool state;
  state.data = request.data;
  valve_pub.publish(state);
  response.success = true;
  return true;
}

static void pressureCallback(const std_msgs::Float64::ConstPtr &pressure) {
  if (pressure->data < call_above)
    return;
  std_srvs::SetBool srv;
  srv.request.data = false;
  if (pressure->data > open_above)
    srv.request.data = true;
  ros::service::call("exp_service_by_name/valve", srv);
}

int main(int argc, char **argv) {
  ros::init(argc, argv, "exp_service_by_name");
  ros::NodeHandle nh;
  nh.param("call_above", call_above, 1.0);
  nh.param("open_above", open_above, 6.0);

  ros::CallbackQueue service_queue;
  ros::NodeHandle service_nh;
  service_nh.setCallbackQueue(&service_queue);
  valve_pub = nh.advertise<std_msgs::Bool>("output", 1000);
  ros::ServiceServer server =
      service_nh.advertiseService("exp_service_by_name/valve", valve);
  ros::AsyncSpinner spinner(1, &service_queue);
  spinner.start();

  ros::Subscriber sub = nh.subscribe("input", 1000, pressureCallback);
  ros::spin();
}
