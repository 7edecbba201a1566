// A service answers later, by send_response.
#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/float64.hpp>
#include <std_srvs/srv/set_bool.hpp>

using std_msgs::msg::Float64;
using std_srvs::srv::SetBool;

class Guard : public rclcpp::Node {
public:
  Guard() : Node("exp_service_deferred") {
    limit_ = declare_parameter("limit", 5.0);
    wait_ = declare_parameter("wait", 2);
    service_ = create_service<SetBool>(
        "~/judge", [this](const std::shared_ptr<rmw_request_id_t> header,
                          const std::shared_ptr<SetBool::Request>) {
          waiting_.push_back(*header);
        });
    client_ = create_client<SetBool>("~/judge");
    pub_ = create_publisher<Float64>("~/output", 100);
    sub_ = create_subscription<Float64>(
        "input", 100, [this](const Float64 &msg) { onInput(msg); });
    timer_ =
        create_wall_timer(std::chrono::milliseconds(5), [this] { answer(); });
    client_->wait_for_service();
  }

private:
  void answer() {
    if (waiting_.empty())
      return;
    if (++count_ < wait_)
      return;
    SetBool::Response response;
    if (last_ > limit_)
      response.success = true;
    service_->send_response(waiting_.front(), response);
    waiting_.erase(waiting_.begin());
  }

  void onInput(const Float64 &msg) {
    last_ = msg.data;
    client_->async_send_request(std::make_shared<SetBool::Request>(),
                                [this](rclcpp::Client<SetBool>::SharedFuture) {
                                  pub_->publish(Float64());
                                });
  }

  rclcpp::Publisher<Float64>::SharedPtr pub_;
  rclcpp::Subscription<Float64>::SharedPtr sub_;
  rclcpp::Service<SetBool>::SharedPtr service_;
  rclcpp::Client<SetBool>::SharedPtr client_;
  rclcpp::TimerBase::SharedPtr timer_;
  std::vector<rmw_request_id_t> waiting_;
  double limit_, last_ = 0.0;
  int wait_, count_ = 0;
};

int main(int argc, char **argv) {
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Guard>());
  rclcpp::shutdown();
  return 0;
}
