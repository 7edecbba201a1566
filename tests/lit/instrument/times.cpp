// RUN: %native -c %inputs/ros.cpp -o %t.ros.o
// RUN: %native -DLIBRARY -c %s -o %t.times.o
// RUN: %compile -O0 %s -o %t.0.o
// RUN: %link -O0 %t.0.o %t.ros.o %t.times.o -o %t.0
// RUN: %t.0 | FileCheck %s
// RUN: %compile -O2 %s -o %t.2.o
// RUN: %link -O2 %t.2.o %t.ros.o %t.times.o -o %t.2
// RUN: %t.2 | FileCheck %s
//
// Times and durations, which operators of a library compare, are reported in
// seconds; also where the operator may throw.
#include <ros/ros.h>

// As in ros/time.h and ros/duration.h.
namespace ros {
template <class T> struct DurationBase {
  int32_t sec, nsec;
  bool operator>(const T &Other) const;
};
struct Duration : DurationBase<Duration> {
  Duration() : DurationBase{0, 0} {}
  explicit Duration(double);
};
template <class T, class D> struct TimeBase {
  uint32_t sec, nsec;
  T operator+(const D &Other) const;
  D operator-(const T &Other) const;
  bool operator<(const T &Other) const;
  bool operator>=(const T &Other) const;
};
struct Time : TimeBase<Time, Duration> {
  Time() : TimeBase{0, 0} {}
  Time(uint32_t Sec, uint32_t Nsec) : TimeBase{Sec, Nsec} {}
};
} // namespace ros

#ifdef LIBRARY
namespace ros {
static int64_t all(int64_t Sec, int64_t Nsec) {
  return Sec * 1000000000 + Nsec;
}
Duration::Duration(double Seconds) {
  auto Sum = static_cast<int64_t>(Seconds * 1e9);
  sec = static_cast<int32_t>((Sum - (Sum < 0 ? 999999999 : 0)) / 1000000000);
  nsec = static_cast<int32_t>(Sum - sec * int64_t(1000000000));
}
template <>
bool DurationBase<Duration>::operator>(const Duration &Other) const {
  return all(sec, nsec) > all(Other.sec, Other.nsec);
}
template <>
Time TimeBase<Time, Duration>::operator+(const Duration &Other) const {
  int64_t Sum = all(sec, nsec) + all(Other.sec, Other.nsec);
  return {static_cast<uint32_t>(Sum / 1000000000),
          static_cast<uint32_t>(Sum % 1000000000)};
}
template <>
Duration TimeBase<Time, Duration>::operator-(const Time &Other) const {
  return Duration((all(sec, nsec) - all(Other.sec, Other.nsec)) * 1e-9);
}
template <> bool TimeBase<Time, Duration>::operator<(const Time &Other) const {
  return all(sec, nsec) < all(Other.sec, Other.nsec);
}
template <> bool TimeBase<Time, Duration>::operator>=(const Time &Other) const {
  return !(*static_cast<const Time *>(this) < Other);
}
} // namespace ros
#else

struct Guard {
  ~Guard() { ros::Publisher(); }
};

struct Node {
  double Patience;
  ros::Duration Longest;
  ros::Time Last{3000000000, 500000000}, Deadline;
  ros::Publisher Out;

  void step(const ros::Time &Now) {
    Guard Alive;
    if (Now >= Last + ros::Duration(Patience))
      Out.publish(std_msgs::Number());
    if (Last - Now > Longest)
      Out.publish(std_msgs::Number());
    if (Now < Deadline)
      Out.publish(std_msgs::Number());
    // Nobody set this.
    if (Now < Last)
      Out.publish(std_msgs::Number());
  }
};

int main() {
  ros::NodeHandle Handle;
  Node N;
  double Longest, Grace;
  Handle.param("patience", N.Patience, 2.25);
  Handle.param("longest", Longest, -1.5);
  Handle.param("grace", Grace, 4.0);
  N.Longest = ros::Duration(Longest);
  N.Deadline = N.Last + ros::Duration(Grace);
  // CHECK: report 0 cmp 3000000001.5 thresh 3000000002.75 res 0
  // CHECK-NEXT: report 1 cmp -1 thresh -1.5 res 1
  // CHECK-NEXT: published
  // CHECK-NEXT: report 1 cmp 3000000001.5 thresh 3000000004.5 res 1
  // CHECK-NEXT: published
  // CHECK-NOT: report
  N.step({3000000001, 500000000});
}
#endif
