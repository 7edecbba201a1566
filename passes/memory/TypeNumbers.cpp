//===- TypeNumbers.cpp ----------------------------------------------------===//
#include "memory/TypeNumbers.h"

#include "support/Names.h"

#include "llvm/ADT/STLExtras.h"

using namespace llvm;

namespace tpc {

/// True if \p A and \p B have the same fields, recursively. All instances of a
/// class template have its name, whatever their arguments.
static bool looksAlike(const StructType &A, const StructType &B) {
  ArrayRef<Type *> Mine = A.elements(), Theirs = B.elements();
  // A base class has no padding at its end.
  if (A.hasName() && B.hasName() &&
      A.getName().contains(".base") != B.getName().contains(".base")) {
    size_t Common = std::min(Mine.size(), Theirs.size());
    Mine = Mine.take_front(Common);
    Theirs = Theirs.take_front(Common);
  }
  return Mine.size() == Theirs.size() && all_of(zip(Mine, Theirs), [](auto P) {
           auto [One, Other] = P;
           const auto *S = dyn_cast<StructType>(One),
                      *T = dyn_cast<StructType>(Other);
           return One == Other || (S && T && looksAlike(*S, *T));
         });
}

unsigned TypeNumbers::numberOf(StructType *T) {
  if (auto It = Numbers.find(T); It != Numbers.end())
    return It->second;
  // Lambdas and classes of unnamed namespaces are unique to their file. Two
  // types without a name cannot be matched at all.
  if (!T->hasName()) {
    Types.push_back(T);
    return Numbers[T] = Types.size() - 1;
  }
  StringRef Name = plainClassName(*T);
  if (Name == "anon" || Name.contains("(anonymous"))
    Name = T->getName();
  SmallVector<unsigned, 1> &Alike = ByName[Name];
  for (unsigned N : Alike)
    if (looksAlike(*T, *Types[N]))
      return Numbers[T] = N;
  unsigned N = Types.size();
  Types.push_back(T);
  Alike.push_back(N);
  return Numbers[T] = N;
}

bool TypeNumbers::isStandard(unsigned Number) const {
  return Number < Types.size() &&
         plainClassName(*Types[Number]).starts_with("std::");
}

} // namespace tpc
