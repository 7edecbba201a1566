// RUN: %native -c %inputs/ros.cpp -o %t.ros.o
// RUN: %compile -O0 %inputs/node.cpp -o %t.0.o
// RUN: %link -O0 -Wl,-mllvm,-tpc-link-unit=node -Wl,-mllvm,-tpc-static-info=%t.0.json %t.0.o %t.ros.o -o %t.0
// RUN: %compile -O1 %inputs/node.cpp -o %t.1.o
// RUN: %link -O1 -Wl,-mllvm,-tpc-link-unit=node -Wl,-mllvm,-tpc-static-info=%t.1.json %t.1.o %t.ros.o -o %t.1
// RUN: %compile -O2 %inputs/node.cpp -o %t.2.o
// RUN: %link -O2 -Wl,-mllvm,-tpc-link-unit=node -Wl,-mllvm,-tpc-static-info=%t.2.json %t.2.o %t.ros.o -o %t.2
// RUN: %compile -O3 %inputs/node.cpp -o %t.3.o
// RUN: %link -O3 -Wl,-mllvm,-tpc-link-unit=node -Wl,-mllvm,-tpc-static-info=%t.3.json %t.3.o %t.ros.o -o %t.3
// RUN: %python -c "import json,sys; a=[json.load(open(p))['comparisons'] for p in sys.argv[1:]]; assert len(a[0]) == 4, a[0]; assert all(x == a[0] for x in a), a" %t.0.json %t.1.json %t.2.json %t.3.json
//
// The comparisons, three with parameters and one with a constant, are the same
// at -O0, -O1, -O2 and -O3, with keys and distances.
