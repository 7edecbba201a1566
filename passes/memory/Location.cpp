//===- Location.cpp -------------------------------------------------------===//
#include "memory/Location.h"

#include "llvm/ADT/Hashing.h"

using namespace llvm;

namespace tpc {

bool endsWith(ArrayRef<Step> Path, ArrayRef<Step> Tail) {
  return Tail.size() <= Path.size() && equal(Tail, Path.take_back(Tail.size()));
}

bool Location::mayBe(const Location &O) const {
  if (Root && O.Root)
    return *this == O;
  if (Path.empty() || O.Path.empty())
    return false;
  if (Root)
    return endsWith(Path, O.Path);
  if (O.Root)
    return endsWith(O.Path, Path);
  return endsWith(Path, O.Path) || endsWith(O.Path, Path);
}

/// More elements of one array are any of them for a pointer.
static constexpr unsigned MaxItems = 8;

void addTo(Locations &Out, Location L) {
  auto IsIn = [&](const Location &Other) {
    return any_of(Out, [&](const Location &K) { return K.isSame(Other); });
  };
  if (!L.isKnown() || Out.size() >= MaxLocations || IsIn(L))
    return;
  if (L.item().isNumber() && Out.size() >= MaxItems) {
    Location Any = L;
    Any.widen();
    if (static_cast<unsigned>(count(Out, Any)) >= MaxItems) {
      if (!IsIn(Any))
        Out.push_back(std::move(Any));
      return;
    }
  }
  Out.push_back(std::move(L));
}

size_t LocationHash::operator()(const Location &L) const {
  hash_code Hash = hash_combine(L.Root, L.RootItem.Number);
  for (const Step &S : L.Path)
    Hash = hash_combine(Hash, S.Type, S.Index, S.Class, S.Item.Number);
  return Hash;
}

bool LocationIdentity::operator()(const Location &A, const Location &B) const {
  return A.Root == B.Root && A.RootItem.Number == B.RootItem.Number &&
         equal(A.Path, B.Path, [](const Step &S, const Step &T) {
           return S.Type == T.Type && S.Index == T.Index &&
                  S.Class == T.Class && S.Item.Number == T.Item.Number;
         });
}

} // namespace tpc
