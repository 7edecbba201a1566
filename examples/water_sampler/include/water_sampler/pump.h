// One run of the pump: how much flows, and when it has to end.
#ifndef WATER_SAMPLER_PUMP_H
#define WATER_SAMPLER_PUMP_H

#include <cstdint>

#include <ros/ros.h>
#include <water_sampler/PumpStatus.h>
#include <water_sampler/SamplerSensors.h>

namespace water_sampler {

class Pump {
public:
  explicit Pump(ros::NodeHandle &private_nh);

  void start(const ros::Time &now);
  void stop(const ros::Time &now);
  /// Ends the run if the vial is full or something is wrong.
  void update(const SamplerSensors &sensors);

  /// Whether it has rested long enough to be started.
  bool rested(const ros::Time &now) const;
  /// For the motor, 0 to 1.
  double duty(const ros::Time &now) const;
  bool running() const { return running_; }
  bool vialFull() const { return vial_full_; }
  double pumped() const { return pumped_; }
  std::uint8_t fault() const { return fault_; }

private:
  std::uint8_t faultOf(const SamplerSensors &sensors);

  double full_vial_volume_;
  double flow_calibration_;
  double min_flow_;
  double dry_run_timeout_;
  double max_pump_current_;
  double max_pump_time_;
  double pump_rest_time_;
  double soft_start_time_;
  double pump_duty_;
  int jam_readings_;
  bool enable_soft_start_;

  ros::Time started_;
  ros::Time stopped_;
  ros::Time last_flow_;
  ros::Time last_reading_;
  double pumped_ = 0.0;
  int jams_ = 0;
  std::uint8_t fault_ = PumpStatus::OK;
  bool running_ = false;
  bool vial_full_ = false;
};

} // namespace water_sampler

#endif // WATER_SAMPLER_PUMP_H
