#include "alarm.h"
#include <std_msgs/Empty.h>

Alarm::Alarm(ros::NodeHandle &handle) : publisher_(handle.advertise<std_msgs::Empty>("alarm", 1)) {
  handle.param("alarm/heat", heat_, 5.0);
}

void Alarm::heat(double degrees) {
  if (degrees > heat_) // TPC alarm/heat
    publisher_.publish(std_msgs::Empty());
}
