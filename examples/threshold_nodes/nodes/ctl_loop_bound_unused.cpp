// Negative twin of ctl_loop_bound: what the bounded loop computes is only
// logged, the publish after it happens once in any case.
#include <ros/ros.h>
#include <std_msgs/Float64.h>

struct Averager {
  ros::Publisher pub;
  int window = 3;
  double last[8] = {0};
  unsigned next = 0;

  void add(const std_msgs::Float64 &msg) {
    last[next++ % 8] = msg.data;
    double sum = 0.0;
    for (int i = 0; i < window; ++i)
      sum += last[(next + i) % 8];
    ROS_DEBUG("mean %f", sum / window);
    pub.publish(msg);
  }
};

static Averager averager;

static void inputCallback(const std_msgs::Float64::ConstPtr &msg) {
  averager.add(*msg);
}

int main(int argc, char **argv) {
  ros::init(argc, argv, "ctl_loop_bound_unused");
  ros::NodeHandle nh;
  nh.param("window", averager.window, averager.window);
  averager.pub = nh.advertise<std_msgs::Float64>("output", 1000);
  ros::Subscriber sub = nh.subscribe("input", 1000, inputCallback);
  ros::spin();
}
