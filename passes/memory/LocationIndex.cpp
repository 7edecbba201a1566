//===- LocationIndex.cpp --------------------------------------------------===//
#include "memory/LocationIndex.h"

using namespace llvm;

namespace tpc {

LocationIndex::Slot LocationIndex::slotOf(const Location &L) {
  if (L.Path.empty())
    return {L.Root, ~0U};
  return {reinterpret_cast<const void *>(
              static_cast<uintptr_t>(L.Path.back().Type) * 16 + 8),
          L.Path.back().Index};
}

void LocationIndex::add(unsigned N, const Location &L) {
  Exact[{slotOf(L), L.Root}].push_back(N);
  if (L.Root && !L.Path.empty() && Alias.isReachable(L))
    Rooted[slotOf(L)].push_back(N);
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
  if (L.Root)
    ByObject.add(N, {L.Root, {}});
  for (size_t K = 1; K <= L.Path.size(); ++K)
    ByObject.add(
        N, {L.Root, SmallVector<Step, 4>(ArrayRef(L.Path).take_front(K))});
  if (!L.Root && !L.Path.empty())
    ByClass[L.Path[0].Type].push_back(N);
}

} // namespace tpc
