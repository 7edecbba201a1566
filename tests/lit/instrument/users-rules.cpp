// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-gather-results>' -tpc-rules=%inputs/own-rules.json %t.o | FileCheck %s
// RUN: %opt -disable-output -passes=tpc -tpc-link-unit=node -tpc-rules=%inputs/broken-rules.json %t.o 2>&1 | FileCheck %s --check-prefix=BROKEN
//
// The user's own rules: a function that reads a parameter, and one that
// exposes. A file that is not JSON is a failure that names the file, and the
// program is still linked.
// CHECK: comparisons of {{.*}}: 1
// BROKEN: warning: node: {{.*}}broken-rules.json: {{.*}}; this link unit is not changed
namespace own {
template <typename T> struct Box {
  T setting(const char *Name);
};
void tell(double Value);
} // namespace own

void step(own::Box<double> &B, double V) {
  // CHECK: parameter 'limit' relation > {{.*}} at [[#@LINE+1]]:9
  if (V > B.setting("limit"))
    own::tell(V);
}
