// Negative twin of exp_tf2_broadcaster: the transform is sent for every value
// and holds nothing that the thresholds decided.
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
    ++sequence_;
    if (std::abs(position->data) < min_motion_)
      ROS_DEBUG("hardly moved");

    double height = 0.0;
    if (position->data > max_height_)
      height = 1.0;
    highest_ = height;

    geometry_msgs::TransformStamped transform;
    transform.header.stamp = ros::Time(sequence_, 0);
    transform.header.frame_id = "odom";
    transform.child_frame_id = "base";
    transform.transform.translation.x = position->data;
    transform.transform.rotation.w = 1.0;
    broadcaster_.sendTransform(transform);
    pub_.publish(position);
  }

  ros::NodeHandle nh_;
  tf2_ros::TransformBroadcaster broadcaster_;
  ros::Publisher pub_;
  ros::Subscriber sub_;
  double min_motion_, max_height_;
  double highest_ = 0.0;
  uint32_t sequence_ = 0;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "exp_tf2_anyway");
  OdometryFrame frame;
  ros::spin();
  return 0;
}
