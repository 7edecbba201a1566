// Whether a service is called depends on thresholds, and what is done then.
#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/float64.hpp>
#include <std_srvs/srv/set_bool.hpp>

using std_msgs::msg::Float64;
using std_srvs::srv::SetBool;

class Guard : public rclcpp::Node {
public:
  Guard() : Node("exp_client") {
    limit_ = declare_parameter("limit", 2.0);
    answered_ = declare_parameter("answered", 2);
    noted_ = declare_parameter("noted", 4.0);
    service_ = create_service<SetBool>(
        "~/judge", [](const SetBool::Request::SharedPtr request,
                      SetBool::Response::SharedPtr response) {
          response->success = request->data;
        });
    client_ = create_client<SetBool>("~/judge");
    pub_ = create_publisher<Float64>("~/output", 100);
    sub_ = create_subscription<Float64>(
        "input", 100, [this](const Float64 &msg) { onInput(msg); });
    client_->wait_for_service();
  }

private:
  void onInput(const Float64 &msg) {
    if (msg.data > noted_)
      RCLCPP_DEBUG(get_logger(), "noted");
    if (msg.data <= limit_)
      return;
    auto request = std::make_shared<SetBool::Request>();
    request->data = true;
    client_->async_send_request(
        request, std::bind(&Guard::onAnswer, this, std::placeholders::_1));
  }

  void onAnswer(rclcpp::Client<SetBool>::SharedFuture future) {
    if (future.get()->success && ++answers_ >= answered_)
      pub_->publish(Float64());
  }

  rclcpp::Publisher<Float64>::SharedPtr pub_;
  rclcpp::Subscription<Float64>::SharedPtr sub_;
  rclcpp::Service<SetBool>::SharedPtr service_;
  rclcpp::Client<SetBool>::SharedPtr client_;
  double limit_, noted_;
  int answered_, answers_ = 0;
};

int main(int argc, char **argv) {
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Guard>());
  rclcpp::shutdown();
  return 0;
}
