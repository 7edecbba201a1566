// Callbacks made by boost::bind: a member function with a bound threshold and a
// free function with a bound publisher.
#include <boost/bind/bind.hpp>
#include <ros/ros.h>
#include <std_msgs/Float64.h>

class BoundRelay {
public:
  explicit BoundRelay(ros::NodeHandle &nh) {
    using namespace boost::placeholders;
    double limit = 0.0;
    nh.param("bound/limit", limit, 3.0);
    double ceiling;
    nh.param("bound/ceiling", ceiling, 9.0);
    pub_ = nh.advertise<std_msgs::Float64>("output", 1000);
    sub_ = nh.subscribe<std_msgs::Float64>(
        "input", 1000,
        boost::bind(&BoundRelay::relay, this, _1, limit, ceiling));
  }

private:
  void relay(const std_msgs::Float64::ConstPtr &msg, double limit,
             double ceiling) {
    if (msg->data < limit)
      return;
    if (ceiling >= msg->data)
      pub_.publish(msg);
  }

  ros::Publisher pub_;
  ros::Subscriber sub_;
};

static double free_limit;

static void relayNegative(const std_msgs::Float64::ConstPtr &msg,
                          const ros::Publisher &pub) {
  if (msg->data < free_limit)
    pub.publish(msg);
}

int main(int argc, char **argv) {
  ros::init(argc, argv, "thr_boost_bind");
  ros::NodeHandle nh;
  nh.param("free/limit", free_limit, -3.0);
  BoundRelay relay(nh);
  ros::Publisher pub = nh.advertise<std_msgs::Float64>("negative", 1000);
  ros::Subscriber sub = nh.subscribe<std_msgs::Float64>(
      "input", 1000, boost::bind(&relayNegative, boost::placeholders::_1, pub));
  ros::spin();
  return 0;
}
