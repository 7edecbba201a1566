// What a function gives back to the library whose class it overrides.
#include <boost/make_shared.hpp>
#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <std_msgs/Float64.h>

// The node's own interface, with a function of the same form.
class Counter {
public:
  virtual ~Counter() = default;
  virtual bool enough(int count) = 0;
};

class Often : public Counter {
public:
  explicit Often(int most) : most_(most) {}
  bool enough(int count) override { return count > most_; }

private:
  int most_;
};

struct Limits {
  int patience, repeats;
  double warn_above;
};

// A message that waits in a queue of roscpp until roscpp finds it ready.
class Waiting : public ros::CallbackInterface {
public:
  Waiting(const Limits &limits, const ros::Publisher &pub, double value)
      : limits_(limits), pub_(pub), value_(value) {}

  bool ready() override { return asked_++ >= limits_.patience; }

  CallResult call() override {
    if (value_ > limits_.warn_above)
      ROS_WARN("%f is high", value_);
    std_msgs::Float64 out;
    out.data = value_;
    pub_.publish(out);
    if (++sent_ < limits_.repeats)
      return TryAgain;
    return Success;
  }

private:
  const Limits &limits_;
  const ros::Publisher &pub_;
  double value_;
  int asked_ = 0, sent_ = 0;
};

class Queueing {
public:
  Queueing() {
    nh_.param("patience", limits_.patience, 3);
    nh_.param("repeats", limits_.repeats, 2);
    nh_.param("warn_above", limits_.warn_above, 5.0);
    counter_ = boost::make_shared<Often>(nh_.param("most", 100));
    pub_ = nh_.advertise<std_msgs::Float64>("output", 1000);
    sub_ = nh_.subscribe("input", 1000, &Queueing::onInput, this);
  }

private:
  void onInput(const std_msgs::Float64::ConstPtr &msg) {
    if (counter_->enough(++count_))
      ROS_INFO("%d messages", count_);
    queue_.addCallback(boost::make_shared<Waiting>(limits_, pub_, msg->data));
    while (!queue_.isEmpty())
      queue_.callOne();
  }

  ros::NodeHandle nh_;
  ros::Publisher pub_;
  ros::Subscriber sub_;
  ros::CallbackQueue queue_;
  boost::shared_ptr<Counter> counter_;
  Limits limits_;
  int count_ = 0;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "exp_overriding");
  Queueing queueing;
  ros::spin();
}
