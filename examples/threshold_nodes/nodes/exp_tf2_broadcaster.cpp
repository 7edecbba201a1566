// The exposing statement is a tf2 broadcaster's sendTransform; one threshold
// decides whether it is called, another what the transform holds.
#include <cmath>
#include <geometry_msgs/TransformStamped.h>
#include <ros/ros.h>
#include <std_msgs/Float64.h>
#include <tf2_ros/transform_broadcaster.h>

class OdometryFrame {
public:
  OdometryFrame() {
    nh_.param("min_motion", min_motion_, 1.5);
    nh_.param("max_height", max_height_, 6.0);
    pub_ = nh_.advertise<std_msgs::Float64>("output", 1000);
    sub_ = nh_.subscribe("input", 1000, &OdometryFrame::onPosition, this);
  }

private:
  void onPosition(const std_msgs::Float64::ConstPtr &position) {
    pub_.publish(position);
    ++sequence_;
    if (std::abs(position->data) < min_motion_)
      return;

    geometry_msgs::TransformStamped transform;
    transform.header.stamp = ros::Time(sequence_, 0);
    transform.header.frame_id = "odom";
    transform.child_frame_id = "base";
    transform.transform.translation.x = position->data;
    if (position->data > max_height_)
      transform.transform.translation.z = 1.0;
    transform.transform.rotation.w = 1.0;
    broadcaster_.sendTransform(transform);
  }

  ros::NodeHandle nh_;
  tf2_ros::TransformBroadcaster broadcaster_;
  ros::Publisher pub_;
  ros::Subscriber sub_;
  double min_motion_, max_height_;
  uint32_t sequence_ = 0;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "exp_tf2_broadcaster");
  OdometryFrame frame;
  ros::spin();
  return 0;
}
