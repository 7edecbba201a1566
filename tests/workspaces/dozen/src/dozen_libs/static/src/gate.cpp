#include <dozen_libs/gate.h>
#include <std_msgs/Float64.h>

Gate::Gate(ros::NodeHandle &handle)
    : level_(handle.param("gate/level", 0.5)),
      publisher_(handle.advertise<std_msgs::Float64>("gate", 1)) {}

void Gate::offer(double value) {
  if (value < level_) // TPC gate/level, most
    return;
  std_msgs::Float64 message;
  message.data = value;
  publisher_.publish(message);
}
