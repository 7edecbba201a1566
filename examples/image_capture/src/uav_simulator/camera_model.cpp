#include "image_capture/camera_model.h"

#include <algorithm>
#include <cmath>

#include "image_capture/limits.h"

namespace image_capture {

namespace {
/// The upright objects in the field, as the camera sees their heads.
constexpr Upright PersonsHead = {0.45, 0.55, 0.6, 0.85};
/// A stone post has a face's features, but is too slim for one.
constexpr Upright Post = {0.3, 0.66, 0.5, 0.8};
constexpr Person PostPlace = {6.5, 0.2};
constexpr std::uint32_t ImageWidth = 640;
constexpr std::uint32_t ImageHeight = 480;
constexpr double ExposureTime = 0.02;
constexpr double MissedImages = 0.03;
/// The person stands before a wall without leaves: half its angle.
constexpr double WallHalfAngle = 0.65;
} // namespace

CameraModel::CameraModel(ros::NodeHandle &private_nh, std::uint32_t seed)
    : noise_(seed), leaves_(seed + 500u) {
  double degrees = 60.0;
  private_nh.getParam("field_of_view_deg", degrees);
  half_angle_ = 0.5 * degrees * M_PI / 180.0;
  private_nh.param("person_x", person_x_, 2.0);
  private_nh.param("person_y", person_y_, 3.75);
  private_nh.param("person_sway", person_sway_, 0.01);
  private_nh.param("camera_range", camera_range_, 8.0);
  private_nh.param("camera_rate", camera_rate_, 10.0);
  private_nh.param("phantom_pause", phantom_pause_, 1.5);
  private_nh.param("clutter_per_image", clutter_per_image_, 0.2);
  schedulePhantom(0.0);
}

Person CameraModel::person(double time) const {
  Person head;
  head.x = person_x_ + person_sway_ * std::sin(0.9 * time);
  head.y = person_y_ + person_sway_ * std::sin(1.3 * time + 1.0);
  return head;
}

Observation CameraModel::observe(const UavState &uav, double time) {
  Observation image;
  image.image_id = images_++;
  image.image_width = ImageWidth;
  image.image_height = ImageHeight;
  image.frame_rate = camera_rate_;
  image.exposure_time = ExposureTime;
  image.yaw_rate = uav.yaw_rate + noise_.gaussian(0.01);
  addClutter(image);
  addPhantom(uav, time, image);
  addUpright(uav, person(time), PersonsHead, image);
  addUpright(uav, PostPlace, Post, image);
  return image;
}

void CameraModel::addUpright(const UavState &uav, const Person &place,
                             const Upright &look, Observation &image) {
  const double dx = place.x - uav.x;
  const double dy = place.y - uav.y;
  const double distance = std::max(std::hypot(dx, dy), 0.3);
  if (distance > camera_range_ || noise_.chance(MissedImages))
    return;
  const double angle = wrapAngle(std::atan2(dy, dx) - uav.yaw);
  const double half_width = 0.5 * look.width / distance;
  if (std::fabs(angle) + half_width > half_angle_)
    return;
  const double scale = 0.5 * ImageWidth / (distance * std::tan(half_angle_));
  addBlob(-angle / half_angle_, scale * look.width, scale * look.height,
          look.contrast, look.response, image);
}

void CameraModel::schedulePhantom(double after) {
  // At least a second passes: the leaves have to swing back.
  phantom_.begin = after + 1.0 + leaves_.waitingTime(phantom_pause_);
  phantom_.end = phantom_.begin + leaves_.uniform(1.0, 1.8);
  phantom_placed_ = false;
}

void CameraModel::addPhantom(const UavState &uav, double time,
                             Observation &image) {
  if (time > phantom_.end)
    schedulePhantom(time);
  if (time < phantom_.begin)
    return;
  if (!phantom_placed_) {
    const double angle = leaves_.uniform(-0.8, 0.8) * half_angle_;
    phantom_.bearing = uav.yaw + angle;
    phantom_.coverage = leaves_.uniform(0.03, 0.16);
    phantom_.aspect = leaves_.uniform(1.0, 1.5);
    phantom_placed_ = true;
  }
  const double angle = wrapAngle(phantom_.bearing - uav.yaw);
  const Person head = person(time);
  const double wall = std::atan2(head.y - uav.y, head.x - uav.x);
  if (std::fabs(angle) > half_angle_ ||
      std::fabs(wrapAngle(phantom_.bearing - wall)) < WallHalfAngle)
    return;
  const double area = phantom_.coverage * ImageWidth * ImageHeight;
  const double width = std::sqrt(area / phantom_.aspect);
  addBlob(-angle / half_angle_, width, width * phantom_.aspect, 0.4, 0.75,
          image);
}

void CameraModel::addClutter(Observation &image) {
  const int blobs = noise_.poisson(clutter_per_image_);
  for (int i = 0; i < blobs; ++i) {
    const double width = noise_.uniform(16.0, 90.0);
    addBlob(noise_.uniform(-1.0, 1.0), width, width * noise_.uniform(0.4, 2.5),
            noise_.uniform(0.1, 0.5), noise_.uniform(0.1, 0.45), image);
  }
}

void CameraModel::addBlob(double offset_x, double width, double height,
                          double contrast, double response,
                          Observation &image) {
  Blob blob;
  blob.offset_x = offset_x + noise_.gaussian(0.01);
  blob.offset_y = noise_.gaussian(0.05);
  blob.width = width * (1.0 + noise_.gaussian(0.02));
  blob.height = height * (1.0 + noise_.gaussian(0.02));
  blob.contrast = std::clamp(contrast + noise_.gaussian(0.03), 0.0, 1.0);
  blob.response = std::clamp(response + noise_.gaussian(0.03), 0.0, 1.0);
  image.blobs.push_back(blob);
}

} // namespace image_capture
