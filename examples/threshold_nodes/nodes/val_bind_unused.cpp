// The twin of val_bind: thresholds are bound and captured, and the functions
// do not compare them, or compare them for the log alone.
#include <boost/bind/bind.hpp>
#include <functional>
#include <ros/ros.h>
#include <std_msgs/Float64.h>

using std_msgs::Float64;

static void forward(const Float64::ConstPtr &msg, double /* limit */,
                    ros::Publisher &pub) {
  if (msg->data > 1.0)
    pub.publish(*msg);
}

int main(int argc, char **argv) {
  ros::init(argc, argv, "val_bind_unused");
  ros::NodeHandle nh;
  ros::Publisher pub = nh.advertise<Float64>("output", 1000);
  ros::Publisher copy = nh.advertise<Float64>("copy", 1000);

  const double limit = nh.param("limit", 5.0);
  ros::Subscriber sub1 = nh.subscribe<Float64>(
      "input", 1000,
      boost::bind(forward, boost::placeholders::_1, limit, boost::ref(pub)));

  double depth = nh.param("depth", -5.0);
  int deep = 0;
  std::function<void(double)> count = [depth, &deep](double value) {
    if (value < depth)
      ++deep;
  };
  std::function<bool(double)> wide =
      std::bind(std::less<double>(), limit, std::placeholders::_1);
  ros::Subscriber sub2 =
      nh.subscribe<Float64>("input", 1000, [&](const Float64::ConstPtr &msg) {
        count(msg->data);
        if (wide(msg->data))
          ROS_INFO("wide: %g", msg->data);
        copy.publish(msg);
      });
  ros::spin();
  ROS_INFO("%d deep values", deep);
  return 0;
}
