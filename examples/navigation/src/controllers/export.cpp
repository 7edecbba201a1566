#include <pluginlib/class_list_macros.hpp>

#include "navigation/pure_pursuit.h"

PLUGINLIB_EXPORT_CLASS(navigation::PurePursuit, navigation::Controller)
