// RUN: %compile -O2 %s -o %t.o
// RUN: %native -DLIBRARY -c %s -o %t.library.o
// RUN: %link -O2 %t.o %t.library.o -o %t
// RUN: %t left | FileCheck %s
// RUN: %native -DLIBRARY -DALONE -c %s -o %t.alone-library.o
// RUN: %link -O2 %t.o %t.alone-library.o -o %t.alone
// RUN: %t.alone left | FileCheck %s --check-prefix=ALONE
//
// Before a read by a node of ROS 2, the program passes the node's full name,
// for which it asks the node, and the name of the parameter as it has put it
// together. Without the log library the program runs as it was written.
// ALONE-NOT: read
// ALONE: published
#include <rclcpp/rclcpp.hpp>
#ifdef LIBRARY
#include <cstdio>

void log_one(char *, bool, double, double, bool) {}

#ifndef ALONE
void log_read_in(char *Key, const char *Node, const void *Name, bool IsText,
                 const void *Object, unsigned long Size) {
  std::printf("read %s in %s as %s %d %d %lu\n", Key, Node,
              static_cast<const std::string *>(Name)->c_str(), IsText,
              Object != nullptr, Size);
}
#endif

namespace rclcpp {
Node::Node(const std::string &) {}
Node::~Node() = default;
const char *Node::get_fully_qualified_name() const { return "/robot1/guard"; }
bool Node::get_parameter(const std::string &, Parameter &) const {
  return false;
}
Parameter::Parameter() = default;
Parameter::~Parameter() = default;
ParameterValue::ParameterValue() : Data(nullptr) {}
template <typename M, typename A>
template <typename T>
std::enable_if_t<std::is_same<T, M>::value>
Publisher<M, A>::publish(const T &) {
  std::puts("published");
}
template void
Publisher<std_msgs::msg::Number>::publish(const std_msgs::msg::Number &);
} // namespace rclcpp
#else
struct Guard {
  double Limit = 1;
  void configure(rclcpp::Node &Of, const std::string &Name) {
    // CHECK: read [[KEY:[-0-9a-f]+]] in /robot1/guard as left.limit 0 1 8
    Of.get_parameter(Name + ".limit", Limit);
  }
};

int main(int, char **Argv) {
  rclcpp::Node Node("guard");
  rclcpp::Publisher<std_msgs::msg::Number> Out;
  Guard G;
  G.configure(Node, Argv[1]);
  double Other = 3;
  // CHECK: read {{[-0-9a-f]+}} in /robot1/guard as other 0 0 0
  Node.get_parameter("other", Other);
  if (Other > G.Limit)
    // CHECK: published
    Out.publish(std_msgs::msg::Number());
}
#endif
