// RUN: %native -c %inputs/ros.cpp -o %t.ros.o
// RUN: %compile -O2 %s -o %t.o
// RUN: %native -DLIBRARY -c %s -o %t.library.o
// RUN: %link -O2 -Wl,-mllvm,-tpc-static-info=%t.json %t.o %t.ros.o %t.library.o -o %t
// RUN: %t low high | FileCheck %s
// RUN: FileCheck %s --check-prefix=JSON --input-file=%t.json
// RUN: %native -Dlog_read=none -c %inputs/ros.cpp -o %t.ros-alone.o
// RUN: %link -O2 %t.o %t.ros-alone.o -o %t.alone
// RUN: %t.alone low high | FileCheck %s --check-prefix=ALONE
//
// Before each parameter read the program passes its handle and its name to the
// log library, with a key that the static information has. Without the library
// the program runs as it was written.
// JSON: "parameters": [
// JSON: "key": "{{[0-9a-f]+-[0-9a-f]+-5[0-9a-f]+-[0-9a-f]+-[0-9a-f]+}}"
// JSON-NEXT: "lineno": {{.*}}
// JSON-NEXT: "name": "<dynamic>"
// ALONE-NOT: read
// ALONE: published out 0
#ifdef LIBRARY
#include <cstdio>
#include <string>

void log_read(char *Key, const void *Handle, const void *Name, bool IsText) {
  std::printf("read %s %d %s %d\n", Key, Handle != nullptr,
              static_cast<const std::string *>(Name)->c_str(), IsText);
}
#else
#include <ros/ros.h>

int main(int, char **Argv) {
  ros::NodeHandle Handle;
  ros::Publisher Out = Handle.advertise<std_msgs::Number>("out", 1);
  double Low, High = 2;
  // CHECK: read [[LOW:[-0-9a-f]+]] 1 low 0
  Handle.param(Argv[1], Low, 1.0);
  // CHECK-NOT: read [[LOW]]
  // CHECK: read {{[-0-9a-f]+}} 1 high 0
  Handle.getParam(Argv[2], High);
  if (Low > High)
    return 0;
  // CHECK: published out 0
  Out.publish(std_msgs::Number());
}
#endif
