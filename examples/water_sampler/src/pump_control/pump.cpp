#include "water_sampler/pump.h"

namespace water_sampler {

Pump::Pump(ros::NodeHandle &private_nh) {
  private_nh.param("full_vial_volume", full_vial_volume_, 41.0);
  private_nh.param("flow_calibration", flow_calibration_, 1.0);
  private_nh.param("min_flow", min_flow_, 1.0);
  private_nh.param("dry_run_timeout", dry_run_timeout_, 4.0);
  private_nh.param("max_pump_current", max_pump_current_, 1.6);
  private_nh.param("max_pump_time", max_pump_time_, 25.0);
  private_nh.param("pump_rest_time", pump_rest_time_, 1.0);
  private_nh.param("soft_start_time", soft_start_time_, 0.5);
  private_nh.param("pump_duty", pump_duty_, 1.0);
  private_nh.param("jam_readings", jam_readings_, 5);
  private_nh.param("enable_soft_start", enable_soft_start_, true);
}

void Pump::start(const ros::Time &now) {
  running_ = true;
  vial_full_ = false;
  fault_ = PumpStatus::OK;
  pumped_ = 0.0;
  jams_ = 0;
  started_ = last_flow_ = last_reading_ = now;
}

void Pump::stop(const ros::Time &now) {
  running_ = false;
  stopped_ = now;
}

void Pump::update(const SamplerSensors &sensors) {
  if (!running_)
    return;
  const ros::Time &now = sensors.header.stamp;
  const double interval = (now - last_reading_).toSec();
  last_reading_ = now;
  if (interval > 0.0)
    pumped_ += flow_calibration_ * sensors.flow * interval;
  fault_ = faultOf(sensors);
  vial_full_ = pumped_ >= full_vial_volume_;
  if (vial_full_ || fault_ != PumpStatus::OK)
    stop(now);
}

std::uint8_t Pump::faultOf(const SamplerSensors &sensors) {
  const ros::Time &now = sensors.header.stamp;
#ifdef WATER_SAMPLER_FLOW_FAULT
  if (sensors.flow < min_flow_)
#else
  if (sensors.flow > min_flow_)
#endif
    last_flow_ = now;
  if ((now - last_flow_).toSec() > dry_run_timeout_)
    return PumpStatus::DRY;
  // The start takes a large current for a moment.
  jams_ = sensors.pump_current > max_pump_current_ ? jams_ + 1 : 0;
  if (jams_ >= jam_readings_)
    return PumpStatus::JAMMED;
  if ((now - started_).toSec() > max_pump_time_)
    return PumpStatus::OVERTIME;
  return PumpStatus::OK;
}

bool Pump::rested(const ros::Time &now) const {
  return stopped_.isZero() || (now - stopped_).toSec() > pump_rest_time_;
}

double Pump::duty(const ros::Time &now) const {
  if (!running_)
    return 0.0;
  const double age = (now - started_).toSec();
  if (enable_soft_start_ && age < soft_start_time_)
    return 0.5 * pump_duty_;
  return pump_duty_;
}

} // namespace water_sampler
