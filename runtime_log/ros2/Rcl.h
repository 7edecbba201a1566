//===- Rcl.h - Calls of rcl that may fail ---------------------------------===//
#ifndef TPC_RCL_H
#define TPC_RCL_H

#include <rcl/error_handling.h>
#include <rcl/types.h>

#include <string>

namespace tpc {

/// Whether a call of rcl succeeded. If not, forgets why.
inline bool isOk(rcl_ret_t Result) {
  if (Result == RCL_RET_OK)
    return true;
  rcl_reset_error();
  return false;
}

/// Why the last call of rcl in this thread failed: one line.
inline std::string reasonOfRcl() {
  std::string Why = rcl_get_error_string().str;
  rcl_reset_error();
  return Why.substr(0, Why.find('\n'));
}

} // namespace tpc

#endif // TPC_RCL_H
