//===- LateCalls.h - Calls of libraries that were there before ------------===//
//
// The dynamic linker sends a call to the first library that has a function of
// that name. If a program loads this library only later, as a container of
// components does, calls of the libraries before it are bound to others. What
// is bound stands in a table of each library; here entries are replaced.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_LATECALLS_H
#define TPC_LATECALLS_H

#include <cstddef>

namespace tpc {

struct LateCall {
  const char *Name;
  void *Ours; ///< what is called from now on
};

/// Lets all libraries and the program, as they are loaded now, call \p Count
/// functions of this library; that which has such a function of its own calls
/// that. Takes tables of 64-bit processors alone.
///
/// \returns how many entries were replaced.
size_t takeCalls(const LateCall *Calls, size_t Count);

} // namespace tpc

#endif // TPC_LATECALLS_H
