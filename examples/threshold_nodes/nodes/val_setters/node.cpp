// Reads the parameters and hands them to the setters of another class, which
// is defined in another file.
#include "battery_monitor.h"
#include <ros/ros.h>
#include <std_msgs/Bool.h>
#include <std_msgs/Float64.h>

int main(int argc, char **argv) {
  ros::init(argc, argv, "val_setters");
  ros::NodeHandle nh;

  BatteryMonitor monitor;
  double min_voltage = 0.0;
  nh.param("min_voltage", min_voltage, -1.0);
  monitor.setMinVoltage(min_voltage);
  monitor.setMaxVoltage(nh.param("max_voltage", 9.0));
  monitor.setPatience(nh.param("patience", 2));
  monitor.setRecovery(nh.param("recovery", 3.0));
  const double quiet = nh.param("quiet_above", -8.0);

  ros::Publisher state = nh.advertise<std_msgs::Bool>("state", 1000);
  ros::Publisher low = nh.advertise<std_msgs::Float64>("low", 1000);
  ros::Subscriber sub = nh.subscribe<std_msgs::Float64>(
      "input", 1000, [&](const std_msgs::Float64::ConstPtr &msg) {
        const double volts = msg->data;
        monitor.update(volts);
        std_msgs::Bool out;
        out.data = monitor.isLow();
        state.publish(out);
        if (monitor.isLow() && volts > quiet)
          low.publish(msg);
      });
  ros::spin();
  return 0;
}
