// How a multirotor flies: attitude and motors respond with a delay, thrust
// lifts, tilt accelerates, air brakes.
#ifndef SIMULATED_WORLD_MULTIROTOR_H
#define SIMULATED_WORLD_MULTIROTOR_H

#include <cmath>

namespace simulated_world {

/// World frame, m, m/s, rad, rad/s; thrust is a share of the full one.
struct MultirotorState {
  double x = 0.0, y = 0.0, z = 0.0;
  double vx = 0.0, vy = 0.0, vz = 0.0;
  double roll = 0.0, pitch = 0.0, yaw = 0.0, yaw_rate = 0.0;
  double thrust = 0.0;
};

/// The command: rad, rad/s, a share of the full thrust.
struct MultirotorInput {
  double roll = 0.0, pitch = 0.0, yaw_rate = 0.0, thrust = 0.0;
};

/// The acceleration by the wind, m/s^2.
struct Wind {
  double x = 0.0, y = 0.0;
};

class Multirotor {
public:
  void step(const MultirotorInput &input, const Wind &wind, double interval) {
    state_.thrust = lag(state_.thrust, input.thrust, interval, MotorLag);
    if (state_.z > 0.0 || state_.vz > 0.0) {
      state_.roll = lag(state_.roll, input.roll, interval, AttitudeLag);
      state_.pitch = lag(state_.pitch, input.pitch, interval, AttitudeLag);
      state_.yaw_rate = lag(state_.yaw_rate, input.yaw_rate, interval, YawLag);
      moveSideways(wind, interval);
    }
    moveUp(interval);
  }
  const MultirotorState &state() const { return state_; }

private:
  static constexpr double Gravity = 9.81;
  static constexpr double HoverThrust = 0.5;
  static constexpr double AttitudeLag = 0.12; // s
  static constexpr double YawLag = 0.15;
  static constexpr double MotorLag = 0.05;
  static constexpr double Drag = 0.3; // 1/s

  static double lag(double value, double target, double interval,
                    double constant) {
    return value + (target - value) * (1.0 - std::exp(-interval / constant));
  }

  void moveSideways(const Wind &wind, double interval) {
    const double c = std::cos(state_.yaw);
    const double s = std::sin(state_.yaw);
    // A positive pitch accelerates forwards, a positive roll to the left.
    const double forward = Gravity * std::tan(state_.pitch);
    const double left = Gravity * std::tan(state_.roll);
    const double ax = c * forward - s * left - Drag * state_.vx + wind.x;
    const double ay = s * forward + c * left - Drag * state_.vy + wind.y;
    state_.vx += ax * interval;
    state_.vy += ay * interval;
    state_.x += state_.vx * interval;
    state_.y += state_.vy * interval;
    state_.yaw =
        std::remainder(state_.yaw + state_.yaw_rate * interval, 2.0 * M_PI);
  }

  void moveUp(double interval) {
    const double lift = state_.thrust / HoverThrust * Gravity *
                        std::cos(state_.roll) * std::cos(state_.pitch);
    state_.vz += (lift - Gravity - Drag * state_.vz) * interval;
    state_.z += state_.vz * interval;
    if (state_.z <= 0.0 && state_.vz <= 0.0) {
      state_.z = 0.0;
      state_.vx = state_.vy = state_.vz = 0.0;
      state_.roll = state_.pitch = state_.yaw_rate = 0.0;
    }
  }

  MultirotorState state_;
};

} // namespace simulated_world

#endif // SIMULATED_WORLD_MULTIROTOR_H
