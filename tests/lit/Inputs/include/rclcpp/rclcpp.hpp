// The part of rclcpp's interface that the tests use, written from its public
// documentation so that the functions have the same mangled names. It is never
// run.
#ifndef TPC_TEST_RCLCPP_H
#define TPC_TEST_RCLCPP_H

#include <chrono>
#include <cstdint>
#include <functional>
#include <future>
#include <map>
#include <memory>
#include <string>
#include <type_traits>
#include <vector>

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
struct ParameterEvent;
struct SetParametersResult {
  bool successful = false;
  std::string reason;
};
} // namespace msg
} // namespace rcl_interfaces

namespace rclcpp {

enum ParameterType : uint8_t {
  PARAMETER_BOOL = 1,
  PARAMETER_INTEGER = 2,
  PARAMETER_DOUBLE = 3
};

class ParameterValue {
public:
  ParameterValue();
  ParameterValue(const ParameterValue &Other);
  explicit ParameterValue(bool Value);
  explicit ParameterValue(int64_t Value);
  explicit ParameterValue(double Value);
  explicit ParameterValue(const std::string &Value);
  template <typename T> const T &get() const {
    return *static_cast<const T *>(Data);
  }
  template <ParameterType N>
  std::enable_if_t<N == PARAMETER_INTEGER, const int64_t &> get() const {
    return get<int64_t>();
  }
  template <ParameterType N>
  std::enable_if_t<N == PARAMETER_DOUBLE, const double &> get() const {
    return get<double>();
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
  const std::vector<double> &as_double_array() const;
  template <typename T> decltype(auto) get_value() const {
    return Value.get<T>();
  }
  template <ParameterType N> decltype(auto) get_value() const {
    return Value.get<N>();
  }

private:
  std::string Name;
  ParameterValue Value;
};

class Duration {
public:
  Duration(int32_t Seconds, uint32_t Nanoseconds);
  explicit Duration(std::chrono::nanoseconds Nanoseconds);
  Duration(const Duration &Other);
  virtual ~Duration() = default;
  Duration &operator=(const Duration &Other);
  bool operator<(const Duration &Other) const;
  bool operator>(const Duration &Other) const;
  Duration operator+(const Duration &Other) const;
  Duration &operator+=(const Duration &Other);
  Duration operator-(const Duration &Other) const;
  Duration operator*(double Factor) const;
  int64_t nanoseconds() const;
  double seconds() const;
  static Duration from_seconds(double Seconds);
  static Duration from_nanoseconds(int64_t Nanoseconds);

private:
  int64_t Held;
};

class Time {
public:
  explicit Time(int64_t Nanoseconds = 0, int Clock = 1);
  Time(const Time &Other);
  virtual ~Time();
  Time &operator=(const Time &Other);
  bool operator<(const Time &Other) const;
  bool operator>(const Time &Other) const;
  Time operator+(const Duration &Other) const;
  Duration operator-(const Time &Other) const;
  int64_t nanoseconds() const;
  double seconds() const;

private:
  int64_t Held;
  int Clock;
};

class QoS {
public:
  QoS(size_t Depth);
};

class Clock;

class Logger {
public:
  void log(const char *Text) const;

private:
  std::shared_ptr<std::string> Name;
};

/// What ROS 2 publishes about a subscription itself.
namespace topic_statistics {
class SubscriptionTopicStatistics;
} // namespace topic_statistics

template <typename M, typename A = std::allocator<void>> class LoanedMessage {
public:
  LoanedMessage(LoanedMessage &&Other) : Of(Other.Of), message_(Other.message_) {
    Other.message_ = nullptr;
  }
  virtual ~LoanedMessage() { release(); }
  M &get() const { return *message_; }

private:
  void release();
  const void *Of;
  M *message_;
};

template <typename M, typename A = std::allocator<void>> class Publisher {
public:
  LoanedMessage<M> borrow_loaned_message();
  void publish(LoanedMessage<M> &&Message);
  virtual ~Publisher() = default;
  template <typename T>
  std::enable_if_t<std::is_same<T, M>::value> publish(const T &Message);
  template <typename T>
  std::enable_if_t<std::is_same<T, M>::value>
  publish(std::unique_ptr<T> Message);
};

template <typename S> class Service {
public:
  virtual ~Service();
};

class SerializedMessage {
public:
  SerializedMessage();

private:
  size_t Length = 0;
};

class GenericPublisher {
public:
  void publish(const SerializedMessage &Message);
};

template <typename S> class Client {
public:
  std::shared_future<int>
  async_send_request(std::shared_ptr<typename S::Request> Request);
};

namespace node_interfaces {
/// Its functions are defined in the library: the debug information of a program
/// does not have them.
class NodeParametersInterface {
public:
  using Descriptor = rcl_interfaces::msg::ParameterDescriptor;
  virtual ~NodeParametersInterface() = default;
  virtual const ParameterValue &
  declare_parameter(const std::string &Name, const ParameterValue &Default,
                    const Descriptor &Of = Descriptor(),
                    bool IgnoreOverride = false) = 0;
  virtual const ParameterValue &
  declare_parameter(const std::string &Name, ParameterType Type,
                    const Descriptor &Of = Descriptor(),
                    bool IgnoreOverride = false) = 0;
  virtual void undeclare_parameter(const std::string &Name) = 0;
  virtual bool has_parameter(const std::string &Name) const = 0;
  virtual std::vector<rcl_interfaces::msg::SetParametersResult>
  set_parameters(const std::vector<Parameter> &All) = 0;
  virtual rcl_interfaces::msg::SetParametersResult
  set_parameters_atomically(const std::vector<Parameter> &All) = 0;
  virtual std::vector<Parameter>
  get_parameters(const std::vector<std::string> &Names) const = 0;
  virtual Parameter get_parameter(const std::string &Name) const = 0;
  virtual bool get_parameter(const std::string &Name,
                             Parameter &Value) const = 0;
};
} // namespace node_interfaces

class Node : public std::enable_shared_from_this<Node> {
public:
  std::shared_ptr<node_interfaces::NodeParametersInterface>
  get_node_parameters_interface();
  using SetCallback = std::function<rcl_interfaces::msg::SetParametersResult(
      const std::vector<Parameter> &)>;
  std::shared_ptr<void> add_on_set_parameters_callback(SetCallback Callback);
  const char *get_fully_qualified_name() const;
  bool has_parameter(const std::string &Name) const;
  Time now() const;
  Logger get_logger() const;
  std::shared_ptr<Clock> get_clock();
  explicit Node(const std::string &Name);
  virtual ~Node();
  bool by_prefix(const std::string &Prefix,
                 std::map<std::string, Parameter> &Found) const;
  const ParameterValue &
  declare_parameter(const std::string &Name, const ParameterValue &Default,
                    const rcl_interfaces::msg::ParameterDescriptor &Descriptor =
                        rcl_interfaces::msg::ParameterDescriptor(),
                    bool IgnoreOverride = false);
  template <typename T>
  auto
  declare_parameter(const std::string &Name, const T &Default,
                    const rcl_interfaces::msg::ParameterDescriptor &Descriptor =
                        rcl_interfaces::msg::ParameterDescriptor(),
                    bool IgnoreOverride = false) {
    return declare_parameter(Name, ParameterValue(Default), Descriptor,
                             IgnoreOverride)
        .get<T>();
  }
  template <typename T>
  auto
  declare_parameter(const std::string &Name,
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
  std::vector<Parameter>
  get_parameters(const std::vector<std::string> &Names) const;
  template <typename T>
  bool get_parameters(const std::string &Prefix,
                      std::map<std::string, T> &Values) const {
    std::map<std::string, Parameter> Found;
    if (!by_prefix(Prefix, Found))
      return false;
    for (const auto &[Key, One] : Found)
      Values[Key] = static_cast<T>(One.template get_value<T>());
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
  template <typename M, typename F>
  void create_subscription(const std::string &Topic, const QoS &,
                           F &&Callback) {
    keepCallback(Topic, std::function<void(std::shared_ptr<M>)>(
                            std::forward<F>(Callback)));
  }
  template <typename M>
  void keepCallback(const std::string &Topic,
                    std::function<void(std::shared_ptr<M>)>);
  std::shared_ptr<GenericPublisher>
  create_generic_publisher(const std::string &Topic, const std::string &Type,
                           const QoS &);
  template <typename S, typename F>
  std::shared_ptr<Service<S>> create_service(const std::string &Name,
                                             F &&Callback, const QoS &Of = 1) {
    return makeService<S>(
        Name,
        std::function<void(std::shared_ptr<typename S::Request>,
                           std::shared_ptr<typename S::Response>)>(
            std::forward<F>(Callback)),
        Of);
  }
  template <typename S>
  std::shared_ptr<Service<S>>
  makeService(const std::string &Name,
              std::function<void(std::shared_ptr<typename S::Request>,
                                 std::shared_ptr<typename S::Response>)>,
              const QoS &);
};

class ParameterEventHandler {
public:
  explicit ParameterEventHandler(Node *Of);
  std::shared_ptr<void>
  add_parameter_callback(const std::string &Name,
                         std::function<void(const Parameter &)> Callback,
                         const std::string &OfNode = "");
  using Event = rcl_interfaces::msg::ParameterEvent;
  static bool get_parameter_from_event(const Event &Of, Parameter &Value,
                                       const std::string &Name,
                                       const std::string &OfNode = "");
  static Parameter get_parameter_from_event(const Event &Of,
                                            const std::string &Name,
                                            const std::string &OfNode = "");
};

namespace topic_statistics {
class SubscriptionTopicStatistics {
public:
  explicit SubscriptionTopicStatistics(Publisher<std_msgs::msg::Number> &Out)
      : Out(Out) {}
  void publish_message_and_reset_measurements(double Age) {
    if (Age > 0)
      Out.publish(std_msgs::msg::Number());
  }

private:
  Publisher<std_msgs::msg::Number> &Out;
};
} // namespace topic_statistics

} // namespace rclcpp

#endif // TPC_TEST_RCLCPP_H
