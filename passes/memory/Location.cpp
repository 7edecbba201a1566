//===- Location.cpp -------------------------------------------------------===//
#include "memory/Location.h"

#include "llvm/ADT/Hashing.h"
#include "llvm/Support/CommandLine.h"

using namespace llvm;

namespace tpc {

void Location::widenAll() {
  if (RootItem.isNumber())
    RootItem = {Nth::Any};
  if (none_of(Path, [](const Step &S) { return S.Item.isNumber(); }))
    return;
  StepPath Wide;
  for (Step S : Path) {
    if (S.Item.isNumber())
      S.Item = {Nth::Any};
    Wide.push_back(S);
  }
  Path = Wide;
}

bool Location::mayBe(const Location &O) const {
  if (Root && O.Root)
    return mayEqual(O);
  if (Path.empty() || O.Path.empty())
    return false;
  if (Root)
    return endsWith(Path, O.Path);
  if (O.Root)
    return endsWith(O.Path, Path);
  return endsWith(Path, O.Path) || endsWith(O.Path, Path);
}

/// Each element is a location of its own. A pointer to more elements of one
/// array counts as pointing to any of them.
static cl::opt<unsigned>
    MaxItems("tpc-max-items", cl::Hidden, cl::init(8),
             cl::desc("Elements of one array that a pointer leads to"));

void addTo(Locations &Out, Location L) {
  auto IsIn = [&](const Location &Other) {
    return any_of(Out, [&](const Location &K) { return K.isSame(Other); });
  };
  if (!L.isKnown() || Out.size() >= MaxLocations || IsIn(L))
    return;
  if (L.item().isNumber() && Out.size() >= MaxItems) {
    Location Any = L;
    Any.widen();
    if (static_cast<unsigned>(count_if(Out, [&](const Location &K) {
          return K.mayEqual(Any);
        })) >= MaxItems) {
      if (!IsIn(Any))
        Out.push_back(std::move(Any));
      return;
    }
  }
  Out.push_back(std::move(L));
}

size_t LocationHash::operator()(const Location &L) const {
  return hash_combine(L.Root, L.RootItem.Number, L.Path.address());
}

} // namespace tpc
