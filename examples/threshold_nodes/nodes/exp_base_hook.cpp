// The base class publishes what a virtual function accepts; the thresholds
// stand in the overrides of two derived classes.
#include <memory>
#include <ros/ros.h>
#include <std_msgs/Float64.h>
#include <vector>

class Stage {
public:
  Stage(ros::NodeHandle &nh, const std::string &topic)
      : pub_(nh.advertise<std_msgs::Float64>(topic, 1000)) {}
  virtual ~Stage() = default;

  void process(const std_msgs::Float64 &msg) {
    if (accept(msg.data))
      pub_.publish(msg);
  }

protected:
  virtual bool accept(double value) = 0;

private:
  ros::Publisher pub_;
};

class HighPass : public Stage {
public:
  explicit HighPass(ros::NodeHandle &nh) : Stage(nh, "high") {
    nh.param("high_pass/cutoff", cutoff_, 2.0);
  }

protected:
  bool accept(double value) override { return value > cutoff_; }

private:
  double cutoff_;
};

class Difference : public Stage {
public:
  explicit Difference(ros::NodeHandle &nh) : Stage(nh, "steps") {
    nh.param("difference/step", step_, 4.0);
  }

protected:
  bool accept(double value) override {
    const double change = value - last_;
    last_ = value;
    return step_ < change;
  }

private:
  double step_;
  double last_ = 0.0;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "exp_base_hook");
  ros::NodeHandle nh;
  std::vector<std::unique_ptr<Stage>> stages;
  stages.push_back(std::make_unique<HighPass>(nh));
  stages.push_back(std::make_unique<Difference>(nh));
  ros::Subscriber sub = nh.subscribe<std_msgs::Float64>(
      "input", 1000, [&stages](const std_msgs::Float64ConstPtr &msg) {
        for (auto &stage : stages)
          stage->process(*msg);
      });
  ros::spin();
  return 0;
}
