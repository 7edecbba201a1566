// Turns in place until a face comes into view.
#ifndef IMAGE_CAPTURE_SEARCH_PATTERN_H
#define IMAGE_CAPTURE_SEARCH_PATTERN_H

#include <ros/ros.h>

namespace image_capture {

class SearchPattern {
public:
  explicit SearchPattern(ros::NodeHandle &private_nh);

  /// Starts to turn at `yaw`, or continues after a face was lost.
  void resume(double yaw, const ros::Time &now);
  /// Counts how far the UAV has turned; called with every new yaw.
  void advance(double yaw);
  /// It has turned past the face that was lost: faces count again.
  bool looking(const ros::Time &now) const;
  /// It has turned often enough without success.
  bool exhausted() const;
  double yawRate() const { return search_yaw_rate_; }

private:
  double search_yaw_rate_;
  double reacquire_delay_;
  int max_search_rotations_;

  double last_yaw_ = 0.0;
  double turned_ = 0.0;
  ros::Time resumed_;
};

} // namespace image_capture

#endif // IMAGE_CAPTURE_SEARCH_PATTERN_H
