#include <dozen_tested/doubler.h>
#include <std_msgs/Float64.h>

void Doubler::connect(ros::NodeHandle &handle) {
  publisher_ = handle.advertise<std_msgs::Float64>("twice", 10, true);
  handle.getParam("most", most_);
}

bool Doubler::offer(double value) {
  if (twice(value) > most_) // TPC most
    return false;
  std_msgs::Float64 message;
  message.data = twice(value);
  if (publisher_)
    publisher_.publish(message);
  return true;
}
