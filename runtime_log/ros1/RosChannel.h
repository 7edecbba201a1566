//===- RosChannel.h - The topics that reports are sent on -----------------===//
#ifndef TPC_ROSCHANNEL_H
#define TPC_ROSCHANNEL_H

#include "Backend.h"

namespace tpc {

/// The topic of the sink \p K.
Channel &rosChannel(SinkKind K);

} // namespace tpc

#endif // TPC_ROSCHANNEL_H
