// The base class reads and the derived class compares, and the other way
// round; a virtual hook between them.
#include <ros/ros.h>
#include <std_msgs/Float64.h>

class SensorBase {
public:
  virtual ~SensorBase() = default;
  void start() {
    readParameters();
    pub_ = nh_.advertise<std_msgs::Float64>("output", 1000);
    sub_ = nh_.subscribe("input", 1000, &SensorBase::onInput, this);
  }

protected:
  virtual void readParameters() { nh_.param("max_range", max_range_, 8.0); }
  virtual bool valid(double value) = 0;

  ros::NodeHandle nh_;
  double max_range_ = 0.0;
  double min_change_ = 0.0;
  int budget_ = 100;

private:
  void onInput(const std_msgs::Float64::ConstPtr &msg) {
    if (!valid(msg->data))
      return;
    if (std::fabs(msg->data - last_) < min_change_)
      return;
    last_ = msg->data;
    for (int i = 0; i < budget_; ++i)
      pub_.publish(msg);
  }

  ros::Publisher pub_;
  ros::Subscriber sub_;
  double last_ = 0.0;
};

class Sonar : public SensorBase {
protected:
  void readParameters() override {
    SensorBase::readParameters();
    nh_.param("min_change", min_change_, 1.0);
    budget_ = nh_.param("copies", 2);
    nh_.param("min_range", min_range_, -8.0);
  }

  bool valid(double value) override {
    if (value > max_range_)
      return false;
    return !(value < min_range_);
  }

private:
  double min_range_ = 0.0;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "val_inherited");
  Sonar sonar;
  sonar.start();
  ros::spin();
  return 0;
}
