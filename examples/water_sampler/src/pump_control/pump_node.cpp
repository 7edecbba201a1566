#include "water_sampler/pump_node.h"

#include <water_sampler/PumpDrive.h>
#include <water_sampler/PumpStatus.h>

namespace water_sampler {

PumpNode::PumpNode(ros::NodeHandle &nh, ros::NodeHandle &private_nh)
    : probe_(private_nh), pump_(private_nh) {
  private_nh.param("min_pump_voltage", min_pump_voltage_, 11.0);
  private_nh.param("vial_count", vial_count_, 3);
  status_pub_ = nh.advertise<PumpStatus>("/pump/status", 10);
  drive_pub_ = nh.advertise<PumpDrive>("/pump/drive", 10);
  sensors_sub_ =
      nh.subscribe("/sampler/sensors", 10, &PumpNode::onSensors, this);
  uav_sub_ = nh.subscribe("/uav/sensors", 10, &PumpNode::onUav, this);
  run_server_ = nh.advertiseService("/pump/run", &PumpNode::onRun, this);
}

void PumpNode::onUav(const UavSensors &sensors) {
  battery_voltage_ = sensors.battery_voltage;
}

void PumpNode::onSensors(const SamplerSensors &sensors) {
  probe_.update(sensors.conductivity);
  pump_.update(sensors);
  publishStatus(sensors.header.stamp);
  publishDrive(sensors.header.stamp);
  ROS_DEBUG("%u shorts of the probe", probe_.shorts());
}

bool PumpNode::onRun(RunPump::Request &request, RunPump::Response &response) {
  const ros::Time now = ros::Time::now();
  if (!request.run) {
    pump_.stop(now);
    response.accepted = true;
    return true;
  }
  response.reason = reasonAgainst(request.vial);
  response.accepted = response.reason.empty();
  if (response.accepted) {
    vial_ = request.vial;
    pump_.start(now);
    publishDrive(now);
  }
  return true;
}

std::string PumpNode::reasonAgainst(std::uint8_t vial) const {
  if (vial >= vial_count_)
    return "no such vial";
  if (battery_voltage_ < min_pump_voltage_)
    return "the battery is too weak";
  if (!pump_.rested(ros::Time::now()))
    return "the pump has to rest";
  return "";
}

void PumpNode::publishStatus(const ros::Time &stamp) {
  PumpStatus status;
  status.header.stamp = stamp;
  status.running = pump_.running();
  status.wet_readings = probe_.wetReadings();
  status.conductivity = probe_.conductivity();
  status.pumped = pump_.pumped();
  status.vial_full = pump_.vialFull();
  status.fault = pump_.fault();
  status_pub_.publish(status);
}

void PumpNode::publishDrive(const ros::Time &stamp) {
  PumpDrive drive;
  drive.header.stamp = stamp;
  drive.duty = pump_.duty(stamp);
  drive.vial = vial_;
  drive_pub_.publish(drive);
}

} // namespace water_sampler
