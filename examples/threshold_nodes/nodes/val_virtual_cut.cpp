// The twin of val_virtual_filter: the implementation that compares parameters
// is an observer whose findings are only logged.
#include <memory>
#include <ros/ros.h>
#include <std_msgs/Float64.h>

class Observer {
public:
  virtual ~Observer() = default;
  virtual void see(double value) = 0;
};

class RangeObserver : public Observer {
public:
  RangeObserver(double low, double high) : low_(low), high_(high) {}
  ~RangeObserver() override { ROS_INFO("%d values out of range", outside_); }
  void see(double value) override {
    if (value < low_ || value > high_)
      outside_++;
  }

private:
  const double low_, high_;
  int outside_ = 0;
};

class SilentObserver : public Observer {
public:
  void see(double) override {}
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "val_virtual_cut");
  ros::NodeHandle nh;
  std::unique_ptr<Observer> observer;
  bool verbose = true;
  ros::param::get("~verbose", verbose);
  if (verbose)
    observer = std::make_unique<RangeObserver>(nh.param("low", -5.0),
                                               nh.param("high", 5.0));
  else
    observer.reset(new SilentObserver());

  ros::Publisher pub = nh.advertise<std_msgs::Float64>("output", 1000);
  ros::Subscriber sub = nh.subscribe<std_msgs::Float64>(
      "input", 1000, [&](const std_msgs::Float64::ConstPtr &msg) {
        observer->see(msg->data);
        pub.publish(msg);
      });
  ros::spin();
  return 0;
}
