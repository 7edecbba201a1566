// Implements the header: parameters come from the environment
// (PARAM_name=value), messages and reports go to the standard output.
#include <ros/ros.h>

#include <cstdio>
#include <cstdlib>

#ifndef NO_LOG_ONE
void log_one(char *Key, bool Result, double Cmp, double Thresh, bool Res) {
  std::printf("report %d cmp %.17g thresh %.17g res %d key %.4s\n", Result, Cmp,
              Thresh, Res, Key);
}
#endif

void test::published(const std::string &Topic, double Value) {
  std::printf("published %s %g\n", Topic.c_str(), Value);
}

namespace ros {

Publisher::Publisher(const Publisher &Other) = default;
Publisher &Publisher::operator=(const Publisher &Other) = default;
Publisher::~Publisher() = default;
ServiceClient::ServiceClient(const ServiceClient &Other) = default;
ServiceClient &ServiceClient::operator=(const ServiceClient &Other) = default;
ServiceClient::~ServiceClient() = default;
NodeHandle::NodeHandle(const std::string &, const Names &) {}
NodeHandle::NodeHandle(const NodeHandle &) {}
NodeHandle::NodeHandle(const NodeHandle &, const std::string &) {}
NodeHandle &NodeHandle::operator=(const NodeHandle &) { return *this; }
NodeHandle::~NodeHandle() = default;

static const char *text(const std::string &Name) {
  return std::getenv(("PARAM_" + Name).c_str());
}

bool NodeHandle::getParam(const std::string &Name, double &Value) const {
  if (const char *T = text(Name))
    return Value = std::atof(T), true;
  return false;
}

bool NodeHandle::getParam(const std::string &Name, int &Value) const {
  if (const char *T = text(Name))
    return Value = std::atoi(T), true;
  return false;
}

bool NodeHandle::getParam(const std::string &Name, bool &Value) const {
  if (const char *T = text(Name))
    return Value = std::atoi(T) != 0, true;
  return false;
}

bool NodeHandle::getParam(const std::string &Name, float &Value) const {
  if (const char *T = text(Name))
    return Value = std::strtof(T, nullptr), true;
  return false;
}

bool NodeHandle::getParam(const std::string &Name, std::string &Value) const {
  if (const char *T = text(Name))
    return Value = T, true;
  return false;
}

Publisher NodeHandle::named(const std::string &Topic) {
  Publisher P;
  P.Topic = Topic;
  return P;
}

ServiceClient NodeHandle::client(const std::string &Name) {
  ServiceClient C;
  C.Name = Name;
  return C;
}

} // namespace ros

/// The log library would take the handles of this file for roscpp's own.
__attribute__((weak)) void log_read(char *, const void *, const void *, bool) {}
