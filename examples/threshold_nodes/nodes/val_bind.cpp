// Thresholds bound into callbacks with boost::bind and std::bind.
#include <boost/bind/bind.hpp>
#include <functional>
#include <ros/ros.h>
#include <std_msgs/Float64.h>

using std_msgs::Float64;

void forwardAbove(const Float64::ConstPtr &msg, double limit,
                  ros::Publisher &pub) {
  if (msg->data > limit)
    pub.publish(*msg);
}

class Meter {
public:
  Meter(ros::NodeHandle &nh, double floor, int every) : every_(every) {
    pub_ = nh.advertise<Float64>("metered", 1000);
    sub_ = nh.subscribe<Float64>(
        "input", 1000,
        boost::bind(&Meter::onInput, this, boost::placeholders::_1, floor));
  }

private:
  void onInput(const Float64::ConstPtr &msg, double floor) {
    if (msg->data < floor)
      return;
    if (++n_ % 2 == 0 && std::bind(&Meter::due, this, every_)())
      pub_.publish(msg);
  }

  bool due(int every) { return n_ >= every; }

  ros::Publisher pub_;
  ros::Subscriber sub_;
  int every_;
  int n_ = 0;
};

static bool below(double limit, double value) { return value < limit; }

int main(int argc, char **argv) {
  ros::init(argc, argv, "val_bind");
  ros::NodeHandle nh;
  ros::Publisher above = nh.advertise<Float64>("above", 1000);
  ros::Publisher beneath = nh.advertise<Float64>("beneath", 1000);

  double limit = nh.param("limit", 5.0);
  ros::Subscriber sub1 =
      nh.subscribe<Float64>("input", 1000,
                            boost::bind(forwardAbove, boost::placeholders::_1,
                                        limit, boost::ref(above)));

  std::function<bool(double)> is_below =
      std::bind(below, nh.param("depth", -5.0), std::placeholders::_1);
  ros::Subscriber sub2 =
      nh.subscribe<Float64>("input", 1000, [&](const Float64::ConstPtr &msg) {
        if (is_below(msg->data))
          beneath.publish(msg);
      });

  Meter meter(nh, nh.param("floor", 0.0), nh.param("every", 10));
  ros::spin();
  return 0;
}
