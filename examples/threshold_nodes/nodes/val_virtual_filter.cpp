// An abstract filter interface with two implementations; only one compares a
// parameter. The filters run through a vector of base pointers.
#include <memory>
#include <ros/ros.h>
#include <std_msgs/Float64.h>
#include <vector>

class Filter {
public:
  virtual ~Filter() = default;
  virtual void configure(ros::NodeHandle &nh) = 0;
  virtual bool update(double in, double &out) = 0;
};

class SpikeFilter : public Filter {
public:
  void configure(ros::NodeHandle &nh) override {
    nh.param("spike", spike_, 6.0);
  }
  bool update(double in, double &out) override {
    const double change = std::fabs(in - last_);
    last_ = in;
    if (change > spike_)
      return false;
    out = in;
    return true;
  }

private:
  double spike_ = 0.0;
  double last_ = 0.0;
};

class MeanFilter : public Filter {
public:
  void configure(ros::NodeHandle &nh) override {
    nh.param("weight", weight_, 0.5);
  }
  bool update(double in, double &out) override {
    mean_ = weight_ * in + (1 - weight_) * mean_;
    out = mean_;
    return true;
  }

private:
  double weight_ = 1.0;
  double mean_ = 0.0;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "val_virtual_filter");
  ros::NodeHandle nh;
  std::vector<std::shared_ptr<Filter>> chain;
  chain.push_back(std::make_shared<SpikeFilter>());
  chain.push_back(std::make_shared<MeanFilter>());
  for (auto &filter : chain)
    filter->configure(nh);

  ros::Publisher pub = nh.advertise<std_msgs::Float64>("output", 1000);
  ros::Subscriber sub = nh.subscribe<std_msgs::Float64>(
      "input", 1000, [&](const std_msgs::Float64::ConstPtr &msg) {
        double value = msg->data;
        for (auto &filter : chain)
          if (!filter->update(value, value))
            return;
        std_msgs::Float64 out;
        out.data = value;
        pub.publish(out);
      });
  ros::spin();
  return 0;
}
