// RUN: %compile -O2 %s -o %t.o
// RUN: %native -DLIBRARY -c %s -o %t.library.o
// RUN: %link -O2 %t.o %t.library.o -o %t
// RUN: %t | FileCheck %s
// RUN: %compile -O0 %s -o %t.0.o
// RUN: %link -O0 %t.0.o %t.library.o -o %t.0
// RUN: %t.0 | FileCheck %s
// RUN: %native -DLIBRARY -DALONE -c %s -o %t.alone-library.o
// RUN: %link -O2 %t.o %t.alone-library.o -o %t.alone
// RUN: %t.alone | FileCheck %s --check-prefix=ALONE
//
// A process of ROS 2 with several nodes says which object is which node once it
// is made: all of the object that the node is a base class of. It says the same
// of the interface by which parameters are read. A read through that passes the
// interface on. Without the log library the program runs as it was written.
// ALONE-NOT: node
// ALONE: published
#include <rclcpp/rclcpp.hpp>
#include <rclcpp_lifecycle/lifecycle_node.hpp>
#ifdef LIBRARY
#include <cstdio>

void log_one(char *, bool, double, double, bool) {}

static void *Interface = &Interface;

#ifndef ALONE
static const void *Last;

void log_node(const char *Node, const void *Object, unsigned long Size) {
  std::printf("node %s %lu%s\n", Node, Size,
              Object == Interface ? " interface"
              : Object == Last    ? " again"
                                  : "");
  Last = Object;
}

void log_read(char *, const void *Handle, const void *Name, bool) {
  std::printf("read %s%s\n", static_cast<const std::string *>(Name)->c_str(),
              Handle == Interface ? " through the interface" : "");
}
#endif

rclcpp::ParameterValue::ParameterValue(const ParameterValue &) = default;

struct Parameters : rclcpp::node_interfaces::NodeParametersInterface {
  const rclcpp::ParameterValue &
  declare_parameter(const std::string &, const rclcpp::ParameterValue &V,
                    const Descriptor &, bool) override {
    return V;
  }
  const rclcpp::ParameterValue &declare_parameter(const std::string &,
                                                  rclcpp::ParameterType,
                                                  const Descriptor &,
                                                  bool) override {
    static rclcpp::ParameterValue None;
    return None;
  }
  void undeclare_parameter(const std::string &) override {}
  bool has_parameter(const std::string &) const override { return true; }
  std::vector<rcl_interfaces::msg::SetParametersResult>
  set_parameters(const std::vector<rclcpp::Parameter> &) override {
    return {};
  }
  rcl_interfaces::msg::SetParametersResult
  set_parameters_atomically(const std::vector<rclcpp::Parameter> &) override {
    return {};
  }
  std::vector<rclcpp::Parameter>
  get_parameters(const std::vector<std::string> &) const override {
    return {};
  }
  rclcpp::Parameter get_parameter(const std::string &) const override {
    return {};
  }
  bool get_parameter(const std::string &, rclcpp::Parameter &) const override {
    return true;
  }
};

namespace rclcpp {
Node::Node(const std::string &) {}
Node::~Node() = default;
const char *Node::get_fully_qualified_name() const { return "/cell/front"; }
std::shared_ptr<node_interfaces::NodeParametersInterface>
Node::get_node_parameters_interface() {
  static auto Only = std::make_shared<Parameters>();
  Interface = Only.get();
  return Only;
}
Parameter::Parameter() = default;
Parameter::Parameter(const Parameter &) = default;
Parameter::~Parameter() = default;
double Parameter::as_double() const { return 0.5; }
ParameterValue::ParameterValue() : Data(nullptr) {}
ParameterValue::ParameterValue(double) : Data(nullptr) {}
template <typename M, typename A>
template <typename T>
std::enable_if_t<std::is_same<T, M>::value>
Publisher<M, A>::publish(const T &) {
  std::puts("published");
}
template void
Publisher<std_msgs::msg::Number>::publish(const std_msgs::msg::Number &);
} // namespace rclcpp
namespace rclcpp_lifecycle {
LifecycleNode::LifecycleNode(const std::string &) {}
LifecycleNode::~LifecycleNode() = default;
const char *LifecycleNode::get_fully_qualified_name() const {
  return "/cell/rear";
}
} // namespace rclcpp_lifecycle
#else
struct Named {
  virtual ~Named() = default;
  double Name[4];
};

// 32 bytes of its own, behind a node; and as the second base class.
struct Front : rclcpp::Node {
  Front() : rclcpp::Node("front") {}
  double Own[4];
};
struct Rear : Named, rclcpp_lifecycle::LifecycleNode {
  Rear() : LifecycleNode("rear") {}
};

static_assert(sizeof(Front) == 56 && sizeof(Rear) == 48);

int main() {
  rclcpp::Publisher<std_msgs::msg::Number> Out;
  // CHECK: node /cell/front 56
  Front F;
  // CHECK-NEXT: node /cell/rear 48
  Rear R;
  // CHECK-NEXT: node /cell/front 1
  auto Plain = std::make_shared<rclcpp::Node>("plain");
  // CHECK-NEXT: node /cell/front 1 interface
  auto Parameters = Plain->get_node_parameters_interface();
  // CHECK-NEXT: read limit through the interface
  double Limit = Parameters->get_parameter("limit").as_double();
  if (Limit < 1)
    // CHECK: published
    Out.publish(std_msgs::msg::Number());
}
#endif
