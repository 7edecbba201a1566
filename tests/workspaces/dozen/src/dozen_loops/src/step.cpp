#include "../include/dozen_loops/step.h"
#include <std_msgs/String.h>

void step(const ros::Publisher &publisher, double value, double limit) {
  if (value > limit) { // TPC limit
    std_msgs::String message;
    message.data = SIDE;
    publisher.publish(message);
  }
}
