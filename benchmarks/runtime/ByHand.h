//===- ByHand.h - log_one of somebody else
//---------------------------------===//
#ifndef TPC_BENCHMARKS_BYHAND_H
#define TPC_BENCHMARKS_BYHAND_H

/// What a report goes through; each of the sources beside this has its own.
void log_one(char *key, bool result, double cmp, double thresh, bool res);

/// As the byte that the plugin puts before a report.
extern char Reporting;

#endif // TPC_BENCHMARKS_BYHAND_H
