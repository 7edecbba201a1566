// Config objects behind shared_ptr and unique_ptr, shared by two users.
#include <boost/make_shared.hpp>
#include <memory>
#include <ros/ros.h>
#include <std_msgs/Float64.h>

struct Options {
  explicit Options(const ros::NodeHandle &nh) {
    nh.param("gate", gate, 2.0);
    nh.getParam("cap", cap);
  }
  double gate;
  double cap = 7.0;
};
typedef boost::shared_ptr<const Options> OptionsConstPtr;

class Gate {
public:
  explicit Gate(OptionsConstPtr options) : options_(std::move(options)) {}
  bool open(double value) const { return value > options_->gate; }

private:
  OptionsConstPtr options_;
};

class Cap {
public:
  explicit Cap(const OptionsConstPtr &options) : options_(options) {}
  double apply(double value) const {
    if (value > options_->cap)
      return options_->cap;
    return value;
  }

private:
  OptionsConstPtr options_;
};

struct Budget {
  int limit = 3;
  int used = 0;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "val_smart_pointers");
  ros::NodeHandle nh;
  auto options = boost::make_shared<Options>(nh);
  Gate gate(options);
  Cap cap(options);
  auto budget = std::make_unique<Budget>();
  nh.param("budget", budget->limit, 4);
  std::shared_ptr<double> reset(new double(nh.param("reset", -4.0)));

  ros::Publisher pub = nh.advertise<std_msgs::Float64>("output", 1000);
  ros::Subscriber sub = nh.subscribe<std_msgs::Float64>(
      "input", 1000,
      [&, reset, b = budget.get()](const std_msgs::Float64::ConstPtr &msg) {
        if (msg->data < *reset)
          b->used = 0;
        if (!gate.open(msg->data))
          return;
        if (b->used >= b->limit)
          return;
        ++b->used;
        std_msgs::Float64 out;
        out.data = cap.apply(msg->data);
        pub.publish(out);
      });
  ros::spin();
  return 0;
}
