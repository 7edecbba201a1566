// The time of a simulated world: its owner publishes it on /clock, keeps its
// pace relative to the wall clock, and lets it wait for nodes that are late.
#ifndef SIMULATED_WORLD_SIMULATED_CLOCK_H
#define SIMULATED_WORLD_SIMULATED_CLOCK_H

#include <cmath>
#include <cstdint>

#include <ros/ros.h>
#include <rosgraph_msgs/Clock.h>

namespace simulated_world {

class SimulatedClock {
public:
  static constexpr double Step = 0.01; ///< s

  explicit SimulatedClock(ros::NodeHandle &nh)
      : clock_pub_(nh.advertise<rosgraph_msgs::Clock>("/clock", 50)) {}

  /// Advances by one step, and publishes the time.
  void advance() {
    ++ticks_;
    rosgraph_msgs::Clock clock;
    clock.clock = stamp();
    clock_pub_.publish(clock);
  }

  /// Sleeps until the wall clock has caught up: `rate` simulated seconds take
  /// one real second.
  void keepPace(double rate) {
    const ros::WallTime now = ros::WallTime::now();
    if (next_.isZero())
      next_ = now;
    next_ += ros::WallDuration(Step / rate);
    if (next_ > now)
      (next_ - now).sleep();
    else if ((now - next_).toSec() > LargestDelay)
      next_ = now; // too slow to keep up: lose time, do not rush
  }

  double now() const { return static_cast<double>(ticks_) * Step; }
  ros::Time stamp() const {
    const std::int64_t milliseconds = ticks_ * 10;
    return ros::Time(static_cast<std::uint32_t>(milliseconds / 1000),
                     static_cast<std::uint32_t>(milliseconds % 1000) *
                         1000000u);
  }
  /// Whether something that is done every `seconds` is due.
  bool every(double seconds) const {
    return ticks_ % std::llround(seconds / Step) == 0;
  }

private:
  static constexpr double LargestDelay = 0.05; // s, of the wall's clock

  ros::Publisher clock_pub_;
  std::int64_t ticks_ = 0;
  ros::WallTime next_;
};

/// Makes the simulated time wait for a node that answers messages: what happens
/// in a mission must not depend on the load of the machine.
class Lockstep {
public:
  /// Stamps of the last message sent, and of the last one answered.
  void sent(const ros::Time &stamp) {
    sent_ = stamp;
    due_ = true;
  }
  void answered(const ros::Time &stamp) { answered_ = stamp; }
  /// Whether it has ever answered.
  bool begun() const { return !answered_.isZero(); }

  /// Spins until the answers are at most `max_lag` (s, simulated) behind the
  /// last message. A node that never answered has not started yet, and is not
  /// waited for.
  void hold(double max_lag) {
    if (!due_ || !begun())
      return;
    due_ = false;
    const ros::Duration most(max_lag);
    double held = 0.0;
    while (ros::ok() && sent_ - answered_ > most && held < LongestHold) {
      ros::WallDuration(Look).sleep();
      held += Look;
      ros::spinOnce();
    }
  }

private:
  static constexpr double Look = 0.001; // s, of the wall's clock
  /// A node that is gone must not stop the time for ever.
  static constexpr double LongestHold = 0.5;

  ros::Time sent_;
  ros::Time answered_;
  bool due_ = false; ///< something was sent since it was waited last
};

} // namespace simulated_world

#endif // SIMULATED_WORLD_SIMULATED_CLOCK_H
