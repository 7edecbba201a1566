// Position, velocity and yaw from the UAV's sensors.
#ifndef IMAGE_CAPTURE_STATE_ESTIMATOR_H
#define IMAGE_CAPTURE_STATE_ESTIMATOR_H

#include <image_capture/UavSensors.h>
#include <ros/ros.h>

#include "image_capture/filters.h"

namespace image_capture {

/// World frame, m, m/s and rad.
struct Estimate {
  double x = 0.0;
  double y = 0.0;
  double z = 0.0;
  double vx = 0.0;
  double vy = 0.0;
  double vz = 0.0;
  double yaw = 0.0;
  double interval = 0.0; ///< since the last sensor message, s
};

class StateEstimator {
public:
  explicit StateEstimator(ros::NodeHandle &private_nh);

  const Estimate &update(const UavSensors &sensors);
  const Estimate &estimate() const { return estimate_; }
  unsigned lateFixes() const { return late_fixes_; }

private:
  void updateLateral(const UavSensors &sensors);
  void updateVelocity();
  double heightFrom(const UavSensors &sensors) const;

  Estimate estimate_;
  ros::Time last_stamp_;
  ros::Time last_fix_;
  FirDerivative fir_x_, fir_y_, fir_z_;
  Difference plain_x_, plain_y_, plain_z_;
  IirLowPass height_filter_;
  bool gps_enable_mode_;
  bool enable_baro_ctrl_mode_;
  bool enable_derv_fir_filter_;
  double sonar_max_range_;
  double flow_timeout_;
  double fix_report_age_;
  double height_filter_alpha_;
  unsigned late_fixes_ = 0;
};

} // namespace image_capture

#endif // IMAGE_CAPTURE_STATE_ESTIMATOR_H
