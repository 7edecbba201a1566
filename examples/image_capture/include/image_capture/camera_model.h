// What the simulated camera sees: the person, and things that look like one.
#ifndef IMAGE_CAPTURE_CAMERA_MODEL_H
#define IMAGE_CAPTURE_CAMERA_MODEL_H

#include <cstdint>

#include <image_capture/Observation.h>
#include <ros/ros.h>
#include <simulated_world/noise.h>

#include "image_capture/uav_dynamics.h"

namespace image_capture {

/// Where the simulated person's head is, m.
struct Person {
  double x = 0.0;
  double y = 0.0;
};

/// How an upright object is seen: m, and 0 to 1.
struct Upright {
  double width = 0.0;
  double height = 0.0;
  double contrast = 0.0;
  double response = 0.0; ///< of the feature bank
};

class CameraModel {
public:
  CameraModel(ros::NodeHandle &private_nh, std::uint32_t seed);

  Observation observe(const UavState &uav, double time);
  Person person(double time) const;

private:
  /// Sunlight in leaves: for about a second a patch has the features of a face.
  struct Phantom {
    double bearing = 0.0;
    double coverage = 0.0;
    double aspect = 1.0;
    double begin = 0.0;
    double end = 0.0;
  };

  void addUpright(const UavState &uav, const Person &place, const Upright &look,
                  Observation &image);
  void addPhantom(const UavState &uav, double time, Observation &image);
  void addClutter(Observation &image);
  void addBlob(double offset_x, double width, double height, double contrast,
               double response, Observation &image);
  void schedulePhantom(double after);

  simulated_world::Noise noise_;
  /// Separate: when the sun comes through does not depend on what else is seen.
  simulated_world::Noise leaves_;
  Phantom phantom_;
  bool phantom_placed_ = false;
  std::uint32_t images_ = 0;
  double half_angle_;
  double person_x_;
  double person_y_;
  double person_sway_;
  double camera_range_;
  double camera_rate_;
  double phantom_pause_;
  double clutter_per_image_;
};

} // namespace image_capture

#endif // IMAGE_CAPTURE_CAMERA_MODEL_H
