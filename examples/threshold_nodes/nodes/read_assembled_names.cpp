// Names put together from constants: std::string and operator+, a character
// array, a member constant, append.
#include <ros/ros.h>
#include <std_msgs/Float64.h>
#include <string>

static const char kHeightName[] = "limits/height";
static const std::string kGroup = "limits";

class Guard {
public:
  Guard() : prefix_("limits/") {
    nh_.param(prefix_ + "speed", speed_, 7.0);
    nh_.param(kHeightName, height_, -7.0);
    nh_.param(kGroup + "/" + "tilt", tilt_, 2.0);
    std::string name("limits/");
    name += "pause";
    nh_.param(name, pause_, 2);
    pub_ = nh_.advertise<std_msgs::Float64>("output", 1000);
    sub_ = nh_.subscribe("input", 1000, &Guard::cb, this);
  }

private:
  void cb(const std_msgs::Float64ConstPtr &m) {
    if (m->data > speed_)
      return;
    if (m->data < height_)
      return;
    if (std::fabs(m->data) > tilt_)
      wait_ = 0;
    if (wait_++ >= pause_)
      pub_.publish(m);
  }

  ros::NodeHandle nh_;
  ros::Publisher pub_;
  ros::Subscriber sub_;
  const std::string prefix_;
  double speed_, height_, tilt_;
  int pause_;
  int wait_ = 0;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "read_assembled_names");
  Guard guard;
  ros::spin();
}
