// Static polymorphism: the base class template calls the derived class, which
// compares; the base compares what the derived class read.
#include <ros/ros.h>
#include <std_msgs/Float64.h>

template <typename Derived> class NodeBase {
public:
  explicit NodeBase(const ros::NodeHandle &nh) : nh_(nh) {
    pub_ = nh_.advertise<std_msgs::Float64>("output", 1000);
    sub_ = nh_.subscribe("input", 1000, &NodeBase::onInput, this);
  }

protected:
  ros::NodeHandle nh_;

private:
  void onInput(const std_msgs::Float64::ConstPtr &msg) {
    Derived &self = static_cast<Derived &>(*this);
    if (!self.accept(msg->data))
      return;
    if (++accepted_ % 2 == 0 && msg->data > self.bonus())
      pub_.publish(msg);
    pub_.publish(msg);
  }

  ros::Publisher pub_;
  ros::Subscriber sub_;
  int accepted_ = 0;
};

class DepthNode : public NodeBase<DepthNode> {
public:
  explicit DepthNode(const ros::NodeHandle &nh) : NodeBase(nh) {
    nh_.param("depth", depth_, -2.0);
    nh_.param("bonus", bonus_, 5.0);
  }

  bool accept(double value) const { return value > depth_; }
  double bonus() const { return bonus_; }

private:
  double depth_;
  double bonus_;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "val_crtp");
  DepthNode node{ros::NodeHandle()};
  ros::spin();
}
