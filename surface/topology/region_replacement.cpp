#include "surface/topology/region_replacement.h"

#include <algorithm>

#include "core/parallel.h"

namespace kappaflow {
namespace {

constexpr int kFirstReach =
    6;  // [cells] around a region: a neighbour further off waits for no round, at first

bool meet(const LatticeBlock& a, const LatticeBlock& b) {
  for (int i = 0; i < 3; ++i)
    if (a.last[i] < b.first[i] || b.last[i] < a.first[i]) return false;
  return true;
}

bool meets_any(const LatticeBlock& block, std::span<const LatticeBlock> others) {
  return std::ranges::any_of(others, [&](const LatticeBlock& other) { return meet(block, other); });
}

/// The box around some cells and those up to `reach` away.
LatticeBlock box_around(std::span<const LatticeCell> cells, int reach) {
  LatticeBlock box{cells[0], cells[0]};
  for (const LatticeCell& c : cells)
    for (int a = 0; a < 3; ++a) {
      box.first[a] = std::min(box.first[a], c[a] - reach);
      box.last[a] = std::max(box.last[a], c[a] + reach);
    }
  return box;
}

/// Those of the pending regions that are not near one before them.
std::vector<int> apart(std::span<const LatticeBlock> box, std::span<const int> pending) {
  std::vector<int> result;
  std::vector<LatticeBlock> taken;
  for (const int r : pending) {
    if (meets_any(box[r], taken)) continue;
    taken.push_back(box[r]);
    result.push_back(r);
  }
  return result;
}

/// Makes the exchange, or leaves the mesh as it is and returns false. vertex_count: of the mesh that it was
/// found for.
bool exchange(const Replacement& found, int vertex_count, MeshEdits& edits, Replaced& replaced) {
  const int shift = static_cast<int>(edits.first_tried()) - vertex_count;
  std::vector<Triangle> added = found.added;
  for (Triangle& t : added)
    for (int& v : t)
      if (v >= vertex_count) v += shift;
  for (std::size_t i = 0; i < found.position.size(); ++i)
    edits.try_vertex(found.position[i], found.gradient[i], found.exact[i] != 0);
  if (!edits.exchange(found.removed, added, found.from)) {
    edits.discard_tried();
    return false;
  }
  replaced.blocks.push_back(found.changed);
  ++replaced.regions;
  replaced.triangles_removed += found.removed.size();
  return true;
}

}  // namespace

void replace_regions(const ReplacementSetting& setting, const std::vector<std::vector<LatticeCell>>& regions,
                     int growth, MeshEdits& edits, VertexCells& vertices, Replaced& replaced) {
  std::vector<LatticeBlock> box;
  std::vector<int> pending;
  for (const std::vector<LatticeCell>& cells : regions) {
    pending.push_back(static_cast<int>(box.size()));
    box.push_back(box_around(cells, growth + kFirstReach));
    std::erase_if(replaced.refused,
                  [&](const LatticeBlock& before) { return meet(before, box_around(cells, 0)); });
  }
  while (!pending.empty()) {
    vertices.add(edits.mesh());
    const int vertex_count = static_cast<int>(edits.mesh().vertex_count());
    const std::vector<int> round = apart(box, pending);
    std::vector<Replacement> found(round.size());
    parallel_for(
        round.size(),
        [&](std::size_t i) {
          found[i] = find_replacement(setting, regions[round[i]], growth, edits, vertices);
        },
        1);
    std::vector<LatticeBlock> changed;
    for (std::size_t i = 0; i < round.size(); ++i) {
      if (meets_any(found[i].read, changed)) {  // the mesh is no longer the one it was found for:
        box[round[i]] = found[i].read;          // it waits until all before it in there is done
        continue;
      }
      std::erase(pending, round[i]);
      if (found[i].is_sound && found[i].removed.empty() && found[i].added.empty()) continue;
      if (found[i].is_sound && exchange(found[i], vertex_count, edits, replaced))
        changed.push_back(found[i].changed);
      else
        for (auto* list : {&replaced.refused, &replaced.failed})
          list->push_back(box_around(regions[round[i]], 0));
    }
  }
}

}  // namespace kappaflow
