//===- Ros1.cpp - What the log library calls ------------------------------===//
#include "HostCalls.h"
#include "ReadNames.h"
#include "ros1/RosChannel.h"
#include "ros1/RosControl.h"

using namespace tpc;

namespace {

class Ros1 final : public Backend {
public:
  int64_t poll() override { return forkedFromNode() ? -1 : pollRos(); }
  void end(bool) override { rosEnd(); }
  bool isForked() override { return forkedFromNode(); }
  const char *nodeName() override { return rosNodeName(); }
  bool timeIsSimulated() override { return rosTimeIsSimulated(); }
  int64_t now() override { return rosNow(); }
  std::string resolveName(const void *Handle,
                          const std::string &Name) override {
    return tpc::resolveName(Handle, Name);
  }
  Channel &channel(SinkKind K) override { return rosChannel(K); }
};

} // namespace

Backend *tpc_make_backend(Host &Of) {
  setHost(Of);
  static auto &Only = *new Ros1;
  return &Only;
}
