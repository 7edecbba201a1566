// Two nodes in one process, with parameters of the same name.
#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/float64.hpp>

using std_msgs::msg::Float64;

class Watcher : public rclcpp::Node {
public:
  explicit Watcher(const rclcpp::NodeOptions &options)
      : Node("watcher_of_two", options) {
    limit_ = declare_parameter("limit", 3.0);
    noted_ = declare_parameter("noted", 4.0);
    sub_ =
        create_subscription<Float64>("input", 100, [this](const Float64 &msg) {
          if (msg.data > limit_)
            ++seen_;
          if (msg.data > noted_)
            RCLCPP_DEBUG(get_logger(), "noted %d", seen_);
        });
  }

private:
  rclcpp::Subscription<Float64>::SharedPtr sub_;
  double limit_, noted_;
  int seen_ = 0;
};

class Guard : public rclcpp::Node {
public:
  explicit Guard(const rclcpp::NodeOptions &options)
      : Node("val_two_nodes", options) {
    limit_ = declare_parameter("limit", 5.0);
    pub_ = create_publisher<Float64>("~/output", 100);
    sub_ =
        create_subscription<Float64>("input", 100, [this](const Float64 &msg) {
          if (msg.data > limit_)
            pub_->publish(msg);
        });
  }

private:
  rclcpp::Publisher<Float64>::SharedPtr pub_;
  rclcpp::Subscription<Float64>::SharedPtr sub_;
  double limit_;
};

int main(int argc, char **argv) {
  rclcpp::init(argc, argv);
  rclcpp::executors::MultiThreadedExecutor executor(rclcpp::ExecutorOptions(),
                                                    2);
  const auto watcher = std::make_shared<Watcher>(rclcpp::NodeOptions());
  const auto guard = std::make_shared<Guard>(rclcpp::NodeOptions());
  executor.add_node(watcher);
  executor.add_node(guard);
  executor.spin();
  rclcpp::shutdown();
  return 0;
}
