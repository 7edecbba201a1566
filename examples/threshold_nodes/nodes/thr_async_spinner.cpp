// An AsyncSpinner serves the input on its own queue while the main thread's
// timer publishes what the callback's threshold let through.
#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <std_msgs/Float64.h>

#include <list>
#include <memory>
#include <mutex>

struct Shared {
  std::mutex mutex;
  std::list<double> accepted;
  unsigned rejected = 0;
};

class Receiver {
public:
  Receiver(std::shared_ptr<Shared> shared)
      : shared_(shared), spinner_(1, &queue_) {
    nh_.param("receiver/max_jump", max_jump_, 9.0);
    nh_.setCallbackQueue(&queue_);
    sub_ = nh_.subscribe("input", 1000, &Receiver::receive, this);
    spinner_.start();
  }

private:
  void receive(const std_msgs::Float64::ConstPtr &msg) {
    const double jump = msg->data - last_;
    last_ = msg->data;
    const std::lock_guard<std::mutex> lock(shared_->mutex);
    if (jump * jump > max_jump_) {
      ++shared_->rejected;
      return;
    }
    shared_->accepted.push_back(msg->data);
  }

  std::shared_ptr<Shared> shared_;
  ros::CallbackQueue queue_;
  ros::NodeHandle nh_;
  ros::Subscriber sub_;
  ros::AsyncSpinner spinner_;
  double max_jump_;
  double last_ = 0.0;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "thr_async_spinner");
  ros::NodeHandle nh;
  auto shared = std::make_shared<Shared>();
  ros::Publisher pub = nh.advertise<std_msgs::Float64>("output", 1000);
  const bool invert = nh.param("sender/invert", false);

  ros::WallTimer timer = nh.createWallTimer(
      ros::WallDuration(0.01), [&](const ros::WallTimerEvent &) {
        const std::lock_guard<std::mutex> lock(shared->mutex);
        for (double value : shared->accepted) {
          std_msgs::Float64 out;
          out.data = invert ? -value : value;
          pub.publish(out);
        }
        shared->accepted.clear();
      });
  Receiver receiver(shared);
  ros::spin();
  return 0;
}
