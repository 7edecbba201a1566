// The part of roscpp's interface that the tests use, with its mangled names
// (names-as-roscpp.cpp compares it with the real one) and small enough to
// compile fast. With Inputs/ros.cpp the programs run without a master:
// parameters come from the environment, messages go to the output.
#ifndef TPC_TEST_ROS_H
#define TPC_TEST_ROS_H

#include <cstdint>
#include <map>
#include <string>

namespace test {
void published(const std::string &Topic, double Value);
}

namespace std_msgs {
struct Number {
  double data = 0;
};
} // namespace std_msgs

namespace ros {

class Publisher {
public:
  Publisher() = default;
  Publisher(const Publisher &Other);
  Publisher &operator=(const Publisher &Other);
  ~Publisher();
  template <typename M> void publish(const M &Message) const {
    test::published(Topic, Message.data);
  }
  std::string Topic;
};

class ServiceClient {
public:
  ServiceClient() = default;
  ServiceClient(const ServiceClient &Other);
  ServiceClient &operator=(const ServiceClient &Other);
  ~ServiceClient();
  template <typename Req, typename Res> bool call(Req &Request, Res &Response) {
    test::published(Name, Request.data);
    Response.data = 1;
    return true;
  }
  std::string Name;
};

class NodeHandle {
public:
  using Names = std::map<std::string, std::string>;
  NodeHandle(const std::string &Namespace = "", const Names &Remapped = {});
  NodeHandle(const NodeHandle &Other);
  NodeHandle(const NodeHandle &Parent, const std::string &Namespace);
  NodeHandle &operator=(const NodeHandle &Other);
  ~NodeHandle();
  template <typename M>
  Publisher advertise(const std::string &Topic, uint32_t, bool = false) {
    return named(Topic);
  }
  template <typename Req, typename Res>
  ServiceClient serviceClient(const std::string &Name, bool = false) {
    return client(Name);
  }
  bool getParam(const std::string &Name, double &Value) const;
  bool getParam(const std::string &Name, int &Value) const;
  bool getParam(const std::string &Name, bool &Value) const;
  bool getParam(const std::string &Name, std::string &Value) const;
  bool getParamCached(const std::string &Name, double &Value) const;
  bool searchParam(const std::string &Key, std::string &Result) const;
  bool getParam(const std::string &Name, float &Value) const;
  template <typename T>
  bool param(const std::string &Name, T &Value, const T &Default) const {
    if (getParam(Name, Value))
      return true;
    Value = Default;
    return false;
  }
  template <typename T>
  T param(const std::string &Name, const T &Default) const {
    T Value;
    param(Name, Value, Default);
    return Value;
  }

private:
  Publisher named(const std::string &Topic);
  ServiceClient client(const std::string &Name);
  std::string Namespace;
};

namespace names {
std::string append(const std::string &Left, const std::string &Right);
} // namespace names

namespace param {
bool get(const std::string &Name, double &Value);
bool getCached(const std::string &Name, double &Value);
template <typename T>
bool param(const std::string &Name, T &Value, const T &Default) {
  if (get(Name, Value))
    return true;
  Value = Default;
  return false;
}
template <typename T> T param(const std::string &Name, const T &Default) {
  T Value;
  param(Name, Value, Default);
  return Value;
}
} // namespace param

} // namespace ros

#endif // TPC_TEST_ROS_H
