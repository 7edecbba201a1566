//===- LocationIndex.cpp --------------------------------------------------===//
#include "memory/LocationIndex.h"

using namespace llvm;

namespace tpc {

LocationIndex::Slot LocationIndex::slotOf(const Value *Root,
                                          ArrayRef<Step> Path) {
  if (Path.empty())
    return {reinterpret_cast<uintptr_t>(Root), ~0U};
  return {static_cast<uintptr_t>(Path.back().Type) * 16 + 8, Path.back().Index};
}

void LocationIndex::add(unsigned N, const Location &L, size_t Steps) {
  Slot Here = slotOf(L.Root, L.Path.steps().take_front(Steps));
  Exact[{Here, L.Root}].push_back(N);
  if (L.Root && Steps && Alias.isReachable(L))
    Rooted[Here].push_back(N);
}

void ObjectIndex::add(unsigned N, const Location &Object) {
  ByLocation.add(N, Object);
  if (!Alias.isReachable(Object))
    return;
  SmallSetVector<unsigned, 8> Classes;
  Types.addClassesIn(Types.typeAt(Object), Classes);
  for (unsigned Class : Classes)
    ByClass[Class].push_back(N);
}

void PartIndex::add(unsigned N, const Location &L) {
  for (size_t Steps = L.Root ? 0 : 1; Steps <= L.Path.size(); ++Steps)
    ByObject.add(N, L, Steps);
  if (!L.Root && !L.Path.empty())
    ByClass[L.Path[0].Type].push_back(N);
}

} // namespace tpc
