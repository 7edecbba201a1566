//===- LogOne.h - What instrumented code calls ----------------------------===//
//
// The instrumentation inserts calls of log_one before predicates; this library
// brings the reports to where they can be read.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_LOGONE_H
#define TPC_LOGONE_H

/// Reports one evaluation of a threshold predicate comparison.
///
/// \param key    the comparison's key, as in the static information
/// \param result what the predicate came to
/// \param cmp    the value that was compared
/// \param thresh the threshold that it was compared with
/// \param res    what this comparison came to
///
/// Safe in any thread and before ros::init; never throws. Instrumented code may
/// rely on it that none of the program's own variables is read or written here.
__attribute__((visibility("default"))) void
log_one(char *key, bool result, double cmp, double thresh, bool res);

#endif // TPC_LOGONE_H
