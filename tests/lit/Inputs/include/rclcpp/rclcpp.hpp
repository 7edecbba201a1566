// The part of rclcpp's interface that the tests use, written from its public
// documentation so that the functions have the same mangled names. It is never
// run.
#ifndef TPC_TEST_RCLCPP_H
#define TPC_TEST_RCLCPP_H

#include <cstdint>
#include <future>
#include <memory>
#include <string>
#include <type_traits>

namespace std_msgs {
namespace msg {
struct Number {
  double data = 0;
};
} // namespace msg
} // namespace std_msgs

namespace rcl_interfaces {
namespace msg {
template <class A> struct ParameterDescriptor_ {
  std::string description;
};
using ParameterDescriptor = ParameterDescriptor_<std::allocator<void>>;
} // namespace msg
} // namespace rcl_interfaces

namespace rclcpp {

enum ParameterType : uint8_t { PARAMETER_BOOL = 1, PARAMETER_DOUBLE = 3 };

class ParameterValue {
public:
  ParameterValue();
  explicit ParameterValue(bool Value);
  explicit ParameterValue(int64_t Value);
  explicit ParameterValue(double Value);
  explicit ParameterValue(const std::string &Value);
  template <typename T> const T &get() const {
    return *static_cast<const T *>(Data);
  }

private:
  const void *Data;
};

class Parameter {
public:
  Parameter();
  Parameter(const Parameter &Other);
  Parameter &operator=(const Parameter &Other);
  ~Parameter();
  const std::string &get_name() const;
  const ParameterValue &get_parameter_value() const;
  bool as_bool() const;
  int64_t as_int() const;
  double as_double() const;
  const std::string &as_string() const;
  template <typename T> decltype(auto) get_value() const {
    return Value.get<T>();
  }

private:
  std::string Name;
  ParameterValue Value;
};

class QoS {
public:
  QoS(size_t Depth);
};

template <typename M, typename A = std::allocator<void>> class Publisher {
public:
  virtual ~Publisher() = default;
  template <typename T>
  std::enable_if_t<std::is_same<T, M>::value> publish(const T &Message);
};

template <typename S> class Client {
public:
  std::shared_future<int>
  async_send_request(std::shared_ptr<typename S::Request> Request);
};

class Node : public std::enable_shared_from_this<Node> {
public:
  explicit Node(const std::string &Name);
  virtual ~Node();
  const ParameterValue &
  declare_parameter(const std::string &Name, const ParameterValue &Default,
                    const rcl_interfaces::msg::ParameterDescriptor &Descriptor =
                        rcl_interfaces::msg::ParameterDescriptor(),
                    bool IgnoreOverride = false);
  template <typename T>
  auto declare_parameter(
      const std::string &Name, const T &Default,
      const rcl_interfaces::msg::ParameterDescriptor &Descriptor =
          rcl_interfaces::msg::ParameterDescriptor(),
      bool IgnoreOverride = false) {
    return declare_parameter(Name, ParameterValue(Default), Descriptor,
                             IgnoreOverride)
        .get<T>();
  }
  template <typename T>
  auto declare_parameter(
      const std::string &Name,
      const rcl_interfaces::msg::ParameterDescriptor &Descriptor =
          rcl_interfaces::msg::ParameterDescriptor(),
      bool IgnoreOverride = false) {
    return declare_parameter(Name, ParameterValue(), Descriptor, IgnoreOverride)
        .get<T>();
  }
  Parameter get_parameter(const std::string &Name) const;
  bool get_parameter(const std::string &Name, Parameter &Value) const;
  template <typename T>
  bool get_parameter(const std::string &Name, T &Value) const {
    Parameter P;
    if (!get_parameter(Name, P))
      return false;
    Value = P.get_value<T>();
    return true;
  }
  template <typename T>
  bool get_parameter_or(const std::string &Name, T &Value,
                        const T &Default) const {
    if (get_parameter(Name, Value))
      return true;
    Value = Default;
    return false;
  }
  template <typename M>
  std::shared_ptr<Publisher<M>> create_publisher(const std::string &Topic,
                                                 const QoS &) {
    return std::make_shared<Publisher<M>>();
  }
};

} // namespace rclcpp

#endif // TPC_TEST_RCLCPP_H
