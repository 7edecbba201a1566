#ifndef THR_SEVERAL_FILES_BATTERY_H
#define THR_SEVERAL_FILES_BATTERY_H

#include <ros/node_handle.h>

struct BatteryLimits {
  double low = 0.0;
  double critical = 0.0;
  int samples = 0;
};

enum class BatteryState { Good, Low, Critical };

/// Decides the state of the battery from its last voltages.
class Battery {
public:
  explicit Battery(const BatteryLimits &limits) : limits_(limits) {}

  void update(double voltage);
  BatteryState state() const { return state_; }

private:
  BatteryLimits limits_;
  BatteryState state_ = BatteryState::Good;
  int low_samples_ = 0;
};

BatteryLimits readLimits(const ros::NodeHandle &nh);

#endif // THR_SEVERAL_FILES_BATTERY_H
