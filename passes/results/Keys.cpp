//===- Keys.cpp -----------------------------------------------------------===//
#include "results/Keys.h"

#include "support/Names.h"

#include "llvm/ADT/StringExtras.h"

using namespace llvm;

namespace tpc {

KeyParts KeyParts::of(const DILocation &Where, StringRef What) {
  return {pathOf(&Where), functionNameFor(Where), Where.getLine(),
          Where.getColumn(), What.str()};
}

std::string nameOfComparison(const KeyParts &Parts, const Options &Opts) {
  return join(
      std::initializer_list<std::string>{
          Opts.Package, Opts.LinkUnit, Opts.relative(Parts.Path),
          Parts.Function, std::to_string(Parts.Line),
          std::to_string(Parts.Column), Parts.What},
      "\n");
}

std::string comparisonKey(std::string Name, size_t Ordinal) {
  if (Ordinal)
    Name += "\n" + std::to_string(Ordinal);
  return uuidOf(Name);
}

std::string readKey(const KeyParts &Parts, const Options &Opts) {
  return uuidOf("read\n" + nameOfComparison(Parts, Opts));
}

} // namespace tpc
