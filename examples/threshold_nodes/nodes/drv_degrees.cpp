// Angles given in degrees and compared in radians, the factor a constant
// expression, a function, and a macro.
#include <cmath>
#include <ros/ros.h>
#include <std_msgs/Float64.h>

#define DEG2RAD(degrees) ((degrees) * M_PI / 180.0)

namespace angles_ {
constexpr double kPerDegree = M_PI / 180.0;
inline double fromDegrees(double degrees) { return degrees * kPerDegree; }
} // namespace angles_

struct Joint {
  double max_angle;
  double min_angle;
  double tolerance;
};

static Joint joint;
static ros::Publisher pub;
static double target = 0.0;

static void angleCallback(const std_msgs::Float64::ConstPtr &msg) {
  const double angle = msg->data / 3.0;
  if (angle > joint.max_angle)
    return;
  if (angle < joint.min_angle)
    return;
  if (std::abs(angle - target) <= joint.tolerance)
    return;
  target = angle;
  pub.publish(msg);
}

int main(int argc, char **argv) {
  ros::init(argc, argv, "drv_degrees");
  ros::NodeHandle nh, pnh("~");
  double degrees;
  pnh.param("max_angle", degrees, 120.0);
  joint.max_angle = DEG2RAD(degrees);
  pnh.param("min_angle", degrees, -150.0);
  joint.min_angle = angles_::fromDegrees(degrees);
  joint.tolerance = pnh.param("tolerance", 10.0) * angles_::kPerDegree;

  pub = nh.advertise<std_msgs::Float64>("output", 1000);
  ros::Subscriber sub = nh.subscribe("input", 1000, angleCallback);
  ros::spin();
  return 0;
}
