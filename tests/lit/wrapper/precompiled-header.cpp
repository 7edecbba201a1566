// RUN: rm -rf %t && mkdir -p %t && cd %t && echo "inline int seven() { return 7; }" > all.h
// RUN: %tpc-clang++ -x c++-header all.h -o all.h.pch && ls all.h.pch
// RUN: rm all.h.pch && %tpc-clang++ -x c++-header all.h && ls all.h.pch
// RUN: %tpc-clang++ -include-pch all.h.pch %s -o one && not ./one
// RUN: %tpc-clang++ -include all.h -c %s -o two.o && %tpc-clang++ two.o -o two && not ./two
//
// A header is precompiled without -c, and nothing is linked.
int main() { return seven(); }
