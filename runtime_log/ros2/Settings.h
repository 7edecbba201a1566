//===- Settings.h - Settings as parameters of a node ----------------------===//
//
// The services of a node with parameters, as every node of ROS 2 has them.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_SETTINGS_H
#define TPC_SETTINGS_H

#include <string>

namespace tpc {

/// Applies what the command line has for the node `NAME/_tpc` and offers its
/// services. If that fails, returns false and sets \p Why.
bool beginSettings(const std::string &Name, std::string &Why);

/// Answers requests.
///
/// \returns whether the middleware wakes the helper thread for the next one.
bool serveSettings();

void endSettings();

} // namespace tpc

#endif // TPC_SETTINGS_H
