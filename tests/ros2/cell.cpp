//===- cell.cpp - Components, and a program with two of their nodes -------===//
//
// Gauge compares the pressures that it hears with a limit of its own: 0 to 9.
// Filter does so for a node that it is told of, as plugins do, and reads its
// parameters as helper functions of navigation do. Pump sends the pressures
// once all gauges and filters listen.
//
// With MAIN, a program with two gauges in an executor of several threads.
//
//===----------------------------------------------------------------------===//
#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/bool.hpp>
#include <std_msgs/msg/float64.hpp>

#include <memory>
#include <string>

using Bool = std_msgs::msg::Bool;
using Pressure = std_msgs::msg::Float64;

static const auto Reliable = rclcpp::QoS(100).reliable();

/// As nav2_util has it.
template <typename NodeT>
void declareIfNotDeclared(NodeT Node, const std::string &Name, double Default) {
  if (!Node->has_parameter(Name))
    Node->declare_parameter(Name, rclcpp::ParameterValue(Default));
}

namespace cell {

class Gauge : public rclcpp::Node {
public:
  explicit Gauge(const rclcpp::NodeOptions &Options)
      : Node("gauge",
             rclcpp::NodeOptions(Options).use_intra_process_comms(true)) {
    Low = declare_parameter("limits.low", 4.5);
    Out = create_publisher<Bool>("alarm", 1);
    In = create_subscription<Pressure>(
        "pressure", Reliable,
        [this](Pressure::UniquePtr Of) { hear(Of->data); });
    // What only a callback reads has no other name.
    Set = add_on_set_parameters_callback(
        [this](const std::vector<rclcpp::Parameter> &All) {
          rcl_interfaces::msg::SetParametersResult Result;
          Result.successful = true;
          for (const rclcpp::Parameter &P : All)
            if (P.get_name() == "limits.low")
              Low = P.as_double();
          return Result;
        });
  }

private:
  void hear(double Pressure) {
    if (Pressure > Low) {
      Bool Message;
      Message.data = true;
      Out->publish(Message);
    }
  }

  double Low;
  rclcpp::Publisher<Bool>::SharedPtr Out;
  rclcpp::Subscription<Pressure>::SharedPtr In;
  rclcpp::node_interfaces::OnSetParametersCallbackHandle::SharedPtr Set;
};

/// A plugin: it belongs to a node, and is none.
class Filter {
public:
  void configure(const rclcpp::Node::SharedPtr &Node, const std::string &Name) {
    declareIfNotDeclared(Node, Name + ".high", 6.5);
    Node->get_parameter(Name + ".high", High);
    const auto Parameters = Node->get_node_parameters_interface();
    declareIfNotDeclared(Parameters, Name + ".least", 1.5);
    Least = Parameters->get_parameter(Name + ".least").as_double();
  }
  bool isHigh(double Pressure) const { return Pressure > High; }
  bool isLeast(double Pressure) const { return Pressure < Least; }

private:
  double High = 0, Least = 0;
};

/// A component need not be derived from a node.
class Filtered {
public:
  explicit Filtered(const rclcpp::NodeOptions &Options)
      : Node(std::make_shared<rclcpp::Node>(
            "filtered",
            rclcpp::NodeOptions(Options).use_intra_process_comms(true))) {
    By.configure(Node, "by");
    Out = Node->create_publisher<Bool>("alarm", 1);
    In = Node->create_subscription<Pressure>("pressure", Reliable,
                                             [this](Pressure::UniquePtr Of) {
                                               Bool Message;
                                               if (By.isHigh(Of->data))
                                                 Out->publish(Message);
                                               if (By.isLeast(Of->data))
                                                 Out->publish(Message);
                                             });
  }
  rclcpp::node_interfaces::NodeBaseInterface::SharedPtr
  get_node_base_interface() const {
    return Node->get_node_base_interface();
  }

private:
  rclcpp::Node::SharedPtr Node;
  Filter By;
  rclcpp::Publisher<Bool>::SharedPtr Out;
  rclcpp::Subscription<Pressure>::SharedPtr In;
};

class Pump : public rclcpp::Node {
public:
  explicit Pump(const rclcpp::NodeOptions &Options)
      : Node("pump",
             rclcpp::NodeOptions(Options).use_intra_process_comms(true)) {
    Wanted = static_cast<size_t>(declare_parameter("listeners", 2));
    Out = create_publisher<Pressure>("pressure", Reliable);
    Timer =
        create_wall_timer(std::chrono::milliseconds(20), [this] { turn(); });
  }

private:
  void turn() {
    if (Out->get_subscription_count() < Wanted)
      return;
    Timer->cancel();
    for (int I = 0; I < 10; ++I) {
      auto Message = std::make_unique<Pressure>();
      Message->data = I;
      Out->publish(std::move(Message));
    }
  }

  size_t Wanted;
  rclcpp::Publisher<Pressure>::SharedPtr Out;
  rclcpp::TimerBase::SharedPtr Timer;
};

} // namespace cell

#ifdef MAIN
int main(int Count, char **Words) {
  rclcpp::init(Count, Words);
  const auto Named = [](const std::string &Name, double Low) {
    return rclcpp::NodeOptions()
        .arguments({"--ros-args", "-r", "__node:=" + Name})
        .append_parameter_override("limits.low", Low);
  };
  const auto Left = std::make_shared<cell::Gauge>(Named("left", 4.5));
  const auto Right = std::make_shared<cell::Gauge>(Named("right", 7.5));
  const auto From = std::make_shared<cell::Pump>(rclcpp::NodeOptions());
  rclcpp::executors::MultiThreadedExecutor Executor({}, 4);
  Executor.add_node(Left);
  Executor.add_node(Right);
  Executor.add_node(From);
  Executor.spin();
  rclcpp::shutdown();
}
#else
#include <rclcpp_components/register_node_macro.hpp>
RCLCPP_COMPONENTS_REGISTER_NODE(cell::Gauge)
RCLCPP_COMPONENTS_REGISTER_NODE(cell::Filtered)
RCLCPP_COMPONENTS_REGISTER_NODE(cell::Pump)
#endif
