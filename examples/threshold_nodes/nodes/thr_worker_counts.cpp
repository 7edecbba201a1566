// Negative twin of thr_callback_to_worker: the thread empties the queue into a
// statistic, the callback publishes every value.
#include <condition_variable>
#include <mutex>
#include <queue>
#include <ros/ros.h>
#include <std_msgs/Float64.h>
#include <thread>

class Pipeline {
public:
  Pipeline() : pnh_("~") {
    pnh_.param("drop_below", drop_below_, -8.0);
    pnh_.param("large_above", large_above_, 4.0);
    pub_ = nh_.advertise<std_msgs::Float64>("output", 1000);
    worker_ = std::thread([this] { work(); });
    sub_ = nh_.subscribe("input", 1000, &Pipeline::enqueue, this);
  }

  ~Pipeline() {
    worker_.join();
    ROS_INFO("%d large values", large_);
  }

private:
  void enqueue(const std_msgs::Float64::ConstPtr &msg) {
    pub_.publish(msg);
    if (msg->data < drop_below_)
      return;
    std::lock_guard<std::mutex> lock(mutex_);
    queue_.push(msg->data);
    filled_.notify_one();
  }

  void work() {
    while (ros::ok()) {
      std::unique_lock<std::mutex> lock(mutex_);
      filled_.wait_for(lock, std::chrono::milliseconds(10));
      while (!queue_.empty()) {
        if (queue_.front() > large_above_)
          ++large_;
        queue_.pop();
      }
    }
  }

  ros::NodeHandle nh_, pnh_;
  ros::Publisher pub_;
  ros::Subscriber sub_;
  double drop_below_, large_above_;
  int large_ = 0;
  std::mutex mutex_;
  std::condition_variable filled_;
  std::queue<double> queue_;
  std::thread worker_;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "thr_worker_counts");
  Pipeline pipeline;
  ros::spin();
  return 0;
}
