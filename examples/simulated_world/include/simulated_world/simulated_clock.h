// The time of a simulated world: who owns it tells it on /clock, keeps its pace
// beside the wall's, and lets it wait for nodes that are late.
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

  /// One step further, and tells everybody.
  void advance() {
    ++ticks_;
    rosgraph_msgs::Clock clock;
    clock.clock = stamp();
    clock_pub_.publish(clock);
  }

  /// Sleeps until the wall's clock has come as far: `rate` simulated seconds in
  /// one of its own.
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
  /// Whether something that is done each `seconds` is due.
  bool every(double seconds) const {
    return ticks_ % std::llround(seconds / Step) == 0;
  }

private:
  static constexpr double LargestDelay = 0.05; // s, of the wall's clock

  ros::Publisher clock_pub_;
  std::int64_t ticks_ = 0;
  ros::WallTime next_;
};

/// Lets the simulated time wait for a node that answers what it is sent: what
/// happens in a mission must not depend on the machine's load.
class Lockstep {
public:
  /// Stamps of what was sent, and of that to which there was an answer.
  void sent(const ros::Time &stamp) {
    sent_ = stamp;
    due_ = true;
  }
  void answered(const ros::Time &stamp) { answered_ = stamp; }
  /// Whether it has answered at all.
  bool begun() const { return !answered_.isZero(); }

  /// Spins until the answers to what was sent last are at most `max_lag` (s,
  /// simulated) behind. A node that never answered has not begun, and is not
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
  /// A node that is gone must not stop the time for good.
  static constexpr double LongestHold = 0.5;

  ros::Time sent_;
  ros::Time answered_;
  bool due_ = false; ///< something was sent since it was waited last
};

} // namespace simulated_world

#endif // SIMULATED_WORLD_SIMULATED_CLOCK_H
