// What a service answers is decided by thresholds.
#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/float64.hpp>
#include <std_srvs/srv/set_bool.hpp>

using std_msgs::msg::Float64;
using std_srvs::srv::SetBool;

class Guard : public rclcpp::Node {
public:
  Guard() : Node("exp_service") {
    limit_ = declare_parameter("limit", 5.0);
    tolerance_ = declare_parameter("tolerance", 4.0);
    noted_ = declare_parameter("noted", 2.0);
    using namespace std::placeholders;
    service_ = create_service<SetBool>(
        "~/judge", std::bind(&Guard::onJudge, this, _1, _2));
    client_ = create_client<SetBool>("~/judge");
    pub_ = create_publisher<Float64>("~/output", 100);
    sub_ = create_subscription<Float64>(
        "input", 100, [this](const Float64 &msg) { onInput(msg); });
    client_->wait_for_service();
  }

private:
  void onJudge(const std::shared_ptr<SetBool::Request> request,
               std::shared_ptr<SetBool::Response> response) {
    const double value = request->data ? 6.0 : 0.0;
    response->message = value > limit_ ? "high" : "low";
    if (value > tolerance_)
      response->success = true;
    if (value > noted_)
      RCLCPP_DEBUG(get_logger(), "noted");
  }

  void onInput(const Float64 &msg) {
    auto request = std::make_shared<SetBool::Request>();
    request->data = msg.data > 0.0;
    client_->async_send_request(
        request, [this](rclcpp::Client<SetBool>::SharedFuture answer) {
          Float64 out;
          out.data = answer.get()->success;
          pub_->publish(out);
        });
  }

  rclcpp::Publisher<Float64>::SharedPtr pub_;
  rclcpp::Subscription<Float64>::SharedPtr sub_;
  rclcpp::Service<SetBool>::SharedPtr service_;
  rclcpp::Client<SetBool>::SharedPtr client_;
  double limit_, tolerance_, noted_;
};

int main(int argc, char **argv) {
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Guard>());
  rclcpp::shutdown();
  return 0;
}
