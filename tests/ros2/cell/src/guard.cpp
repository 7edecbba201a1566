// A node with two publishers, a timer and the kinds of parameters that rclcpp
// has. A line that compares parameters ends in their names.
#include <chrono>
#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/float64.hpp>
#include <std_msgs/msg/string.hpp>

class Guard : public rclcpp::Node {
public:
  Guard() : Node("guard", "/robot1") {
    declare_parameter("limits.speed", 6.5);
    get_parameter("limits.speed", Speed);
    Min = declare_parameter("min", -1.0);
    Patience = rclcpp::Duration::from_seconds(declare_parameter("patience", 0.1));
    Weights = declare_parameter<std::vector<double>>("weights", {1.0, 4.0});
    Mode = declare_parameter<std::string>("mode", "fast");
    get_parameter_or("use", Use, true);
    get_parameter_or("angle_deg", Angle, 90.0);
    Angle = Angle * M_PI / 180.0;
    Stop = create_publisher<std_msgs::msg::Float64>("stop", 10);
    Said = create_publisher<std_msgs::msg::String>("said", 10);
    Timer = create_wall_timer(std::chrono::milliseconds(10), [this] { step(); });
    Last = now();
  }

private:
  void step() {
    std_msgs::msg::Float64 M;
    std_msgs::msg::String S;
    M.data = double(N++ % 10);
    if (N == 40)
      rclcpp::shutdown();
    if (M.data > Speed) // limits.speed
      Stop->publish(M);
    if (M.data < Min) // min
      return;
    if (Use && M.data > Weights[1]) // use weights
      Stop->publish(M);
    if (now() - Last > Patience) { // patience
      Said->publish(S);
      Last = now();
    }
    if (Mode == "fast") // mode
      Said->publish(S);
    if (std::sin(M.data) * 3 > Angle) // angle_deg
      Said->publish(S);
  }

  double Speed = 0, Min = 0, Angle = 0;
  int N = 0;
  bool Use = false;
  rclcpp::Duration Patience{0, 0};
  std::vector<double> Weights;
  std::string Mode;
  rclcpp::Publisher<std_msgs::msg::Float64>::SharedPtr Stop;
  rclcpp::Publisher<std_msgs::msg::String>::SharedPtr Said;
  rclcpp::TimerBase::SharedPtr Timer;
  rclcpp::Time Last;
};

int main(int Count, char **Words) {
  rclcpp::init(Count, Words);
  rclcpp::spin(std::make_shared<Guard>());
  rclcpp::shutdown();
}
