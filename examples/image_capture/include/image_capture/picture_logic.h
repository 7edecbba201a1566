// Decides whether a face is worth a picture, and how many pictures are enough.
#ifndef IMAGE_CAPTURE_PICTURE_LOGIC_H
#define IMAGE_CAPTURE_PICTURE_LOGIC_H

#include <cstdint>
#include <vector>

#include <ros/ros.h>

namespace image_capture {

class PictureLogic {
public:
  explicit PictureLogic(ros::NodeHandle &private_nh);

  /// The face is neither too small nor too large in the image.
  bool coverageInRange(double coverage) const;
  /// The face is near the middle of the image.
  bool centred(double offset_x) const;
  /// The face is too small or too large in the image; `distance` becomes the
  /// distance to the person, in m, at which it would have the right size.
  bool needsMove(double coverage, double &distance) const;
  /// Neither out of pictures nor too soon after the last one.
  bool mayCapture(const ros::Time &now) const;
  /// Another try after `attempts` refused ones.
  bool mayRetry(int attempts) const;

  void noteCapture(const ros::Time &now);
  bool albumFull() const;
  /// One entry for each wanted picture: 1 if it was taken.
  std::vector<std::uint8_t> album() const;
  int selfies() const { return selfies_; }

private:
  double min_coverage_limit_;
  double max_coverage_limit_;
  double center_tolerance_;
  double capture_cooldown_;
  double standoff_distance_;
  int max_selfie_count_;
  int max_capture_attempts_;

  int selfies_ = 0;
  ros::Time last_capture_;
};

} // namespace image_capture

#endif // IMAGE_CAPTURE_PICTURE_LOGIC_H
