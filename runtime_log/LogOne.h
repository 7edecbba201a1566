//===- LogOne.h - What instrumented code calls ----------------------------===//
//
// The instrumentation inserts calls of log_one before predicates. This library
// takes the reports to a place where they can be read.
//
//===----------------------------------------------------------------------===//
#ifndef TPC_LOGONE_H
#define TPC_LOGONE_H

/// Reports one evaluation of a threshold predicate comparison.
///
/// \param key    the key of the comparison, as in the static information
/// \param result the outcome of the predicate
/// \param cmp    the value that was compared
/// \param thresh the threshold that it was compared with
/// \param res    the outcome of this comparison
///
/// Safe in any thread and before ros::init; never throws. Reads and writes none
/// of the program's own variables: the compiler relies on that.
__attribute__((visibility("default"))) void
log_one(char *key, bool result, double cmp, double thresh, bool res);

/// The same for a comparison of an object that has parameters of its own. The
/// evaluations of two objects of one class are reported apart.
///
/// \param object its address; nothing is read there
__attribute__((visibility("default"))) void log_one_of(char *key, bool result,
                                                       double cmp,
                                                       double thresh, bool res,
                                                       const void *object);

/// Reports the full name of a parameter, before it is read.
///
/// \param key    the key of the read, as in the static information
/// \param handle the ros::NodeHandle that the name is relative to; null for the
///               node itself. With ROS 2, an object that log_node was called
///               with
/// \param name   a std::string, or with \p text a C string
///
/// Safe in any thread; never throws.
__attribute__((visibility("default"))) void
log_read(char *key, const void *handle, const void *name, bool text) noexcept;

/// The same for a read in a method of \p object, which has \p size bytes.
__attribute__((visibility("default"))) void
log_read_of(char *key, const void *handle, const void *name, bool text,
            const void *object, unsigned long size) noexcept;

/// The same for a node of ROS 2, which has dots in the names of its parameters.
///
/// \param node   the node's full name, such as `/robot1/guard`; null or empty
/// if
///               it is not known: nothing is reported then
/// \param object null if the read is in no method
__attribute__((visibility("default"))) void
log_read_in(char *key, const char *node, const void *name, bool text,
            const void *object, unsigned long size) noexcept;

/// Reports that a node of ROS 2 was made. A process may have several.
///
/// \param node   its full name, such as `/robot1/guard`; null or empty if it is
///               not known: nothing is reported then
/// \param object the node, of \p size bytes with all that is derived from it;
///               or something by which its parameters are read
///
/// Safe in any thread; never throws.
__attribute__((visibility("default"))) void
log_node(const char *node, const void *object, unsigned long size) noexcept;

#endif // TPC_LOGONE_H
