// Parameters that are read and not compared: discarded, logged, published,
// set, and read again by nobody.
#include <ros/ros.h>
#include <std_msgs/Float64.h>

int main(int argc, char **argv) {
  ros::init(argc, argv, "read_discarded");
  ros::NodeHandle nh;

  nh.param("discarded", 1.0);
  double threshold = 2.0;
  double other = 0.0;
  nh.getParam("other_threshold", other);
  ROS_INFO("other_threshold is %g", other);
  const double gain = nh.param("gain", 0.5);
  ros::param::set("~last_threshold", threshold);

  ros::Publisher pub = nh.advertise<std_msgs::Float64>("output", 1000);
  auto callback = [&pub, threshold, gain](const std_msgs::Float64ConstPtr &m) {
    if (m->data > threshold) {
      std_msgs::Float64 out;
      out.data = gain;
      pub.publish(out);
    }
  };
  ros::Subscriber sub =
      nh.subscribe<std_msgs::Float64>("input", 1000, callback);
  ros::spin();
  return 0;
}
