//===- RclChannel.h - The topics that reports are sent on -----------------===//
#ifndef TPC_RCLCHANNEL_H
#define TPC_RCLCHANNEL_H

#include "Backend.h"

namespace tpc {

/// The topic of the sink \p K: auto and topic share one.
Channel &rclChannel(SinkKind K);

/// No code may use a channel after this call.
void endRclChannels();

} // namespace tpc

#endif // TPC_RCLCHANNEL_H
