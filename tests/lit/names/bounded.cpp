// RUN: %compile -O2 %s -o %t.o
// RUN: %opt -disable-output -passes='tpc-prepare,print<tpc-param-calls>' %t.o | FileCheck %s
//
// A name that doubles with each line becomes unknown; the analysis does not fail.
#include <ros/ros.h>

static std::string twice(const std::string &S) { return S + S; }

double V;

// CHECK: parameter reads of {{.*}}: 2
// CHECK: 'aaaa'
// CHECK: '<dynamic>'
int main() {
  ros::NodeHandle Handle;
  Handle.param(twice(twice("a")), V, 1.0);
  std::string A = "a", B = A + A, C = B + B, D = C + C, E = D + D, F = E + E;
  std::string G = F + F, H = G + G, I = H + H, J = I + I, K = J + J, L = K + K;
  std::string M = L + L, N = M + M, O = N + N, P = O + O, Q = P + P, R = Q + Q;
  std::string S = R + R, T = S + S, U = T + T, W = U + U, X = W + W, Y = X + X;
  Handle.param(Y, V, 1.0);
}
