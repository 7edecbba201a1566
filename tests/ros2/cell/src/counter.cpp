// A server of an action and, in the same process, its client.
#include <rclcpp/rclcpp.hpp>
#include <rclcpp_action/rclcpp_action.hpp>
#include <test_msgs/action/fibonacci.hpp>
#include <thread>

using Fibonacci = test_msgs::action::Fibonacci;
using Handle = rclcpp_action::ServerGoalHandle<Fibonacci>;

class Counter : public rclcpp::Node {
public:
  Counter() : Node("counter") {
    Largest = declare_parameter("largest_order", 20);
    Every = declare_parameter("feedback_every", 2);
    Cap = declare_parameter("cap", 50);
    Server = rclcpp_action::create_server<Fibonacci>(
        this, "fibonacci",
        [this](const rclcpp_action::GoalUUID &, std::shared_ptr<const Fibonacci::Goal> Goal) {
          if (Goal->order > Largest) // largest_order
            return rclcpp_action::GoalResponse::REJECT;
          return rclcpp_action::GoalResponse::ACCEPT_AND_EXECUTE;
        },
        [](std::shared_ptr<Handle>) { return rclcpp_action::CancelResponse::ACCEPT; },
        [this](std::shared_ptr<Handle> Of) { execute(*Of); });
  }

private:
  void execute(Handle &Of) {
    auto Feedback = std::make_shared<Fibonacci::Feedback>();
    auto Result = std::make_shared<Fibonacci::Result>();
    auto &Numbers = Feedback->sequence = {0, 1};
    for (int I = 1; I < Of.get_goal()->order; ++I) {
      Numbers.push_back(Numbers[I] + Numbers[I - 1]);
      if (Numbers.back() > Cap) { // cap
        Of.abort(Result);
        return;
      }
      if (I % 4 > Every) // feedback_every
        Of.publish_feedback(Feedback);
    }
    Result->sequence = Numbers;
    Of.succeed(Result);
  }

  int64_t Largest, Every, Cap;
  rclcpp_action::Server<Fibonacci>::SharedPtr Server;
};

int main(int Count, char **Words) {
  rclcpp::init(Count, Words);
  auto Server = std::make_shared<Counter>();
  auto User = std::make_shared<rclcpp::Node>("user");
  auto Client = rclcpp_action::create_client<Fibonacci>(User, "fibonacci");
  rclcpp::executors::SingleThreadedExecutor Executor;
  Executor.add_node(Server);
  Executor.add_node(User);
  std::thread Asking([&] {
    Client->wait_for_action_server();
    // The first one succeeds, the second one has too large numbers, the third is rejected.
    for (int Order : {8, 16, 24}) {
      Fibonacci::Goal Goal;
      Goal.order = Order;
      if (auto Accepted = Client->async_send_goal(Goal).get())
        Client->async_get_result(Accepted).get();
    }
    Executor.cancel();
  });
  Executor.spin();
  Asking.join();
  rclcpp::shutdown();
}
