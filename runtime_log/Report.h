//===- Report.h - One report and its text ---------------------------------===//
#ifndef TPC_REPORT_H
#define TPC_REPORT_H

#include <string>

namespace tpc {

struct Report {
  const char *Key;
  bool Result;
  double Compared;
  double Threshold;
  bool Outcome;
};

/// `KEY,RESULT,cmp:C,thresh:T,res:R` (SPEC 5). Numbers are the shortest text
/// that reads back as the same double.
std::string format(const Report &R);

} // namespace tpc

#endif // TPC_REPORT_H
