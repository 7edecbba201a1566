// Predicates kept in std::function and boost::function members and called
// later, in a timer that drains what the callback collected.
#include <boost/function.hpp>
#include <deque>
#include <functional>
#include <ros/ros.h>
#include <std_msgs/Float64.h>
#include <vector>

class Pipeline {
public:
  using Predicate = std::function<bool(double)>;

  void add(Predicate predicate) { stages_.push_back(std::move(predicate)); }
  void setSelector(const boost::function<double(double)> &f) { selector_ = f; }

  bool run(double value) const {
    for (const auto &stage : stages_)
      if (!stage(value))
        return false;
    return true;
  }

  double select(double value) const { return selector_(value); }

private:
  std::vector<Predicate> stages_;
  boost::function<double(double)> selector_;
};

struct Cap {
  double cap;
  double operator()(double value) const { return value > cap ? cap : value; }
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "val_std_function");
  ros::NodeHandle nh;

  Pipeline pipeline;
  const double upper = nh.param("upper", 8.0);
  pipeline.add([upper](double value) { return value < upper; });
  double lower;
  nh.param("lower", lower, -8.0);
  pipeline.add([&lower](double value) { return value > lower; });
  pipeline.setSelector(Cap{nh.param("cap", 3.0)});

  std::deque<double> pending;
  ros::Publisher pub = nh.advertise<std_msgs::Float64>("output", 1000);
  ros::Subscriber sub = nh.subscribe<std_msgs::Float64>(
      "input", 1000, [&pending](const std_msgs::Float64::ConstPtr &msg) {
        pending.push_back(msg->data);
      });
  ros::WallTimer timer =
      nh.createWallTimer(ros::WallDuration(0.01), [&](const auto &) {
        while (!pending.empty()) {
          const double value = pending.front();
          pending.pop_front();
          if (!pipeline.run(value))
            continue;
          std_msgs::Float64 out;
          out.data = pipeline.select(value);
          pub.publish(out);
        }
      });
  ros::spin();
  return 0;
}
