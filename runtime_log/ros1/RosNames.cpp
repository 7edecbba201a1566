//===- RosNames.cpp - Names as roscpp resolves them -----------------------===//
#include "ReadNames.h"

#include <ros/init.h>
#include <ros/names.h>
#include <ros/node_handle.h>

namespace tpc {

std::string resolveName(const void *Handle, const std::string &Name) {
  if (Handle)
    return static_cast<const ros::NodeHandle *>(Handle)->resolveName(Name);
  // Before ros::init the node has no name yet.
  return ros::isInitialized() ? ros::names::resolve(Name) : "";
}

} // namespace tpc
