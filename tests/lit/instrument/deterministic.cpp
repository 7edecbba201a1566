// RUN: %native -c %inputs/ros.cpp -o %t.ros.o
// RUN: %compile -O2 %inputs/node.cpp -o %t.o
// RUN: %link -O2 -Wl,-mllvm,-tpc-link-unit=node -Wl,-mllvm,-tpc-static-info=%t.1.json %t.o %t.ros.o -o %t.1
// RUN: %link -O2 -Wl,-mllvm,-tpc-link-unit=node -Wl,-mllvm,-tpc-static-info=%t.2.json %t.o %t.ros.o -o %t.2
// RUN: cmp %t.1 %t.2
// RUN: cmp %t.1.json %t.2.json
//
// The same input gives the same object code and the same static information.
