// Signed and unsigned integers of several widths, and 64 bits beyond 2^53.
#include <cstdint>
#include <ros/ros.h>
#include <std_msgs/Float64.h>
#include <std_msgs/Int64.h>

class Encoder {
public:
  Encoder() {
    int step, floor, window;
    nh_.param("max_step", step, 9);
    nh_.param("floor", floor, -5);
    nh_.param("window", window, 20);
    max_step_ = static_cast<unsigned>(step);
    floor_ = static_cast<std::int8_t>(floor);
    wrap_at_ = kOrigin + window;
    batch_ = nh_.param("batch", 3);
    pub_ = nh_.advertise<std_msgs::Int64>("ticks", 1000);
    raw_pub_ = nh_.advertise<std_msgs::Float64>("raw", 1000);
    sub_ = nh_.subscribe("input", 1000, &Encoder::onInput, this);
  }

private:
  static constexpr std::int64_t kOrigin = 9007199254740993; // 2^53 + 1

  void onInput(const std_msgs::Float64::ConstPtr &msg) {
    const int change = static_cast<int>(2 * msg->data);
    const unsigned step = static_cast<unsigned>(change < 0 ? -change : change);
    if (step > max_step_)
      return;
    const std::int8_t small = static_cast<std::int8_t>(change);
    if (small >= floor_)
      raw_pub_.publish(msg);

    ticks_ += step;
    if (ticks_ >= wrap_at_)
      ticks_ = kOrigin;
    if (++samples_ < batch_)
      return;
    samples_ = 0;
    std_msgs::Int64 out;
    out.data = ticks_;
    pub_.publish(out);
  }

  ros::NodeHandle nh_;
  ros::Publisher pub_, raw_pub_;
  ros::Subscriber sub_;
  unsigned max_step_;
  std::int8_t floor_;
  std::int64_t wrap_at_;
  std::uint64_t batch_;
  std::int64_t ticks_ = kOrigin;
  std::uint64_t samples_ = 0;
};

int main(int argc, char **argv) {
  ros::init(argc, argv, "cmp_integers");
  Encoder encoder;
  ros::spin();
  return 0;
}
