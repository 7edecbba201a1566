// The part of roscpp's interface that the tests use, with its mangled names
// (names-as-roscpp.cpp holds it against the real one), and small enough that a
// test compiles at once. Inputs/ros.cpp makes programs of it that run without
// a master: parameters come from the environment, messages go to the output.
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
  bool getParam(const std::string &Name, float &Value) const;
  bool getParam(const std::string &Name, std::string &Value) const;
  template <typename T>
  bool param(const std::string &Name, T &Value, const T &Default) const {
    if (getParam(Name, Value))
      return true;
    Value = Default;
    return false;
  }

private:
  Publisher named(const std::string &Topic);
  ServiceClient client(const std::string &Name);
};

} // namespace ros

#endif // TPC_TEST_ROS_H
