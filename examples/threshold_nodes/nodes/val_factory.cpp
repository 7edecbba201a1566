// A factory returns a unique_ptr to an abstract detector; which one is itself
// decided by a parameter.
#include <memory>
#include <ros/ros.h>
#include <std_msgs/Bool.h>
#include <std_msgs/Float64.h>
#include <string>

struct Detector {
  virtual ~Detector() {}
  virtual bool detect(double value) = 0;
};

class LevelDetector final : public Detector {
public:
  explicit LevelDetector(double level) : level_(level) {}
  bool detect(double value) override { return value >= level_; }

private:
  double level_;
};

class HysteresisDetector final : public Detector {
public:
  HysteresisDetector(double on, double off) : on_(on), off_(off) {}
  bool detect(double value) override {
    if (active_ && value < off_)
      active_ = false;
    else if (value > on_)
      active_ = true;
    return active_;
  }

private:
  double on_, off_;
  bool active_ = false;
};

std::unique_ptr<Detector> makeDetector(const ros::NodeHandle &nh) {
  std::string kind;
  nh.param<std::string>("detector", kind, "hysteresis");
  if (kind == "level")
    return std::make_unique<LevelDetector>(nh.param("level", 2.0));
  double on, off;
  nh.param("on", on, 3.0);
  nh.param("off", off, -3.0);
  return std::make_unique<HysteresisDetector>(on, off);
}

int main(int argc, char **argv) {
  ros::init(argc, argv, "val_factory");
  ros::NodeHandle nh;
  std::unique_ptr<Detector> detector = makeDetector(nh);
  ros::Publisher pub = nh.advertise<std_msgs::Bool>("output", 1000);
  bool last = false;
  ros::Subscriber sub = nh.subscribe<std_msgs::Float64>(
      "input", 1000, [&](const std_msgs::Float64::ConstPtr &msg) {
        const bool now = detector->detect(msg->data);
        if (now == last)
          return;
        last = now;
        std_msgs::Bool out;
        out.data = now;
        pub.publish(out);
      });
  ros::spin();
}
