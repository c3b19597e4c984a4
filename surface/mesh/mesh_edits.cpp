#include "surface/mesh/mesh_edits.h"

#include <algorithm>

#include "core/errors.h"
#include "core/sort_unique.h"

namespace kappaflow {

namespace {

/// Whether the triangles at the origin of h, `count` of them, are one closed fan.
bool is_one_fan(std::span<const int> twin, int h, std::ptrdiff_t count) {
  std::ptrdiff_t steps = 0;
  int at = h;
  do {
    at = twin[previous_half_edge(at)];
    ++steps;
  } while (at >= 0 && at != h && steps < count);
  return at == h && steps == count;
}

}  // namespace

void MeshEdits::start(TriangleMesh& mesh, const EditGuard* guard) {
  mesh_ = &mesh;
  guard_ = guard;
  history_.vertices_at_start = static_cast<int>(mesh.vertex_count());
  touched_.assign(mesh.vertex_count(), 0);
  made_ = 0;
  set_twins();
}

void MeshEdits::set_twins() {
  twins_of(mesh_->triangles, sides_, twin_);
  if (const auto open = std::ranges::find(twin_, -1); open != twin_.end())
    throw TopologyError(mesh_->position[end(static_cast<int>(open - twin_.begin()))],
                        "a mesh to be edited is not closed and manifold here");
  set_first_half_edges();
}

void MeshEdits::finish() {
  alive_.resize(out_.size());
  for (std::size_t v = 0; v < out_.size(); ++v) alive_[v] = out_[v] >= 0;
  history_.touched.resize(touched_.size());
  std::ranges::transform(touched_, history_.touched.begin(), [](std::uint32_t edit) { return edit > 0; });
  remove_dead(alive_, *mesh_, history_);
  history_.keep(history_.touched);
  mesh_ = nullptr;
  guard_ = nullptr;
}

int MeshEdits::valence(int v) const {
  int n = 0;
  for_each_out(v, [&](int) { ++n; });
  return n;
}

int MeshEdits::find(int u, int v) const {
  if (!is_alive(u) || !is_alive(v)) return -1;
  int found = -1;
  all_out(u, [&](int h) {
    if (end(h) == v) found = h;
    return found < 0;
  });
  return found;
}

void MeshEdits::link(int h, int twin) {
  twin_[h] = twin;
  twin_[twin] = h;
}

/// For an edit that changes all triangles around v.
void MeshEdits::touch_fan(int v) {
  touched_[v] = made_;
  for_each_out(v, [&](int out) { touched_[end(out)] = made_; });
}

int MeshEdits::add_vertex(const VertexBlend& from, const Vec3& x) {
  const int v = static_cast<int>(mesh_->vertex_count());
  mesh_->position.push_back(x);
  complete_vertex(*mesh_, v, &from);
  out_.push_back(-1);
  touched_.push_back(made_);
  return v;
}

int MeshEdits::add_triangle(const Triangle& triangle) {
  mesh_->triangles.push_back(triangle);
  twin_.resize(twin_.size() + 3, -1);
  return static_cast<int>(mesh_->triangles.size()) - 1;
}

bool MeshEdits::can_split(int h, const Vec3& x) const {
  const Vec3 &u = at(origin(h)), &v = at(end(h));
  return allows(u, v, at(apex(h)), x) && allows(v, u, at(apex(twin_[h])), x);
}

int MeshEdits::split(int h, double share, const Vec3& x) {
  if (!can_split(h, x)) return -1;
  const int t = twin_[h], u = origin(h), v = end(h), a = apex(h), b = apex(t);
  ++made_;
  touch({u, v, a, b});
  const int va = twin_[next_half_edge(h)], au = twin_[previous_half_edge(h)], ub = twin_[next_half_edge(t)],
            bv = twin_[previous_half_edge(t)];
  const int m = add_vertex({{u, v, v}, {1 - share, share, 0}}, x);
  const int left = h / 3, right = t / 3, new_left = add_triangle({m, v, a}),
            new_right = add_triangle({m, u, b});
  mesh_->triangles[left] = {u, m, a};
  mesh_->triangles[right] = {v, m, b};
  link(3 * left, 3 * new_right);
  link(3 * left + 1, 3 * new_left + 2);
  link(3 * left + 2, au);
  link(3 * new_left, 3 * right);
  link(3 * new_left + 1, va);
  link(3 * right + 1, 3 * new_right + 2);
  link(3 * right + 2, bv);
  link(3 * new_right + 1, ub);
  out_[u] = 3 * left;
  out_[v] = 3 * right;
  out_[a] = 3 * left + 2;
  out_[b] = 3 * right + 2;
  out_[m] = 3 * new_left;
  return m;
}

bool MeshEdits::can_split_triangle(int triangle, const Vec3& x) const {
  const auto& [a, b, c] = mesh_->triangles[triangle];
  return allows(at(a), at(b), at(c), x);
}

int MeshEdits::split(int triangle, const VertexBlend& from, const Vec3& x) {
  if (!can_split_triangle(triangle, x)) return -1;
  const auto [a, b, c] = mesh_->triangles[triangle];
  ++made_;
  touch({a, b, c});
  const int first = 3 * triangle, bc = twin_[first + 1], ca = twin_[first + 2];
  const int m = add_vertex(from, x), second = 3 * add_triangle({b, c, m}),
            third = 3 * add_triangle({c, a, m});
  mesh_->triangles[triangle] = {a, b, m};
  link(first + 1, second + 2);
  link(second + 1, third + 2);
  link(third + 1, first + 2);
  link(second, bc);
  link(third, ca);
  out_[a] = first;
  out_[b] = second;
  out_[c] = third;
  out_[m] = first + 2;
  return m;
}

bool MeshEdits::can_collapse(int h) const {
  const int u = origin(h), v = end(h);
  if (valence(apex(h)) <= 3 || valence(apex(twin_[h])) <= 3) return false;
  int common = 0;
  for_each_out(v, [&](int out) { common += find(u, end(out)) >= 0; });
  return common == 2 && allows_fan(u, at(v));
}

/// Whether the triangles around v may go along with it to x.
bool MeshEdits::allows_fan(int v, const Vec3& x) const {
  return guard_ == nullptr ||
         all_out(v, [&](int out) { return guard_->allows(at(v), at(end(out)), at(apex(out)), x); });
}

bool MeshEdits::collapse(int h, bool asked) {
  if (!asked && !can_collapse(h)) return false;
  const int t = twin_[h], u = origin(h), v = end(h), a = apex(h), b = apex(t);
  const int va = twin_[next_half_edge(h)], au = twin_[previous_half_edge(h)], ub = twin_[next_half_edge(t)],
            bv = twin_[previous_half_edge(t)];
  ++made_;
  touch_fan(u);
  for_each_out(u, [&](int out) { mesh_->triangles[out / 3][out % 3] = v; });
  link(va, au);
  link(ub, bv);
  mesh_->triangles[h / 3] = kRemovedTriangle;
  mesh_->triangles[t / 3] = kRemovedTriangle;
  out_[u] = -1;
  out_[v] = au;
  out_[a] = va;
  out_[b] = ub;
  return true;
}

bool MeshEdits::flip(int h) {
  const int t = twin_[h], u = origin(h), v = end(h), a = apex(h), b = apex(t);
  if (valence(u) <= 3 || valence(v) <= 3 || find(a, b) >= 0 || !allows(at(u), at(v), at(a), at(b)))
    return false;
  const int va = twin_[next_half_edge(h)], au = twin_[previous_half_edge(h)], ub = twin_[next_half_edge(t)],
            bv = twin_[previous_half_edge(t)];
  const int left = h / 3, right = t / 3;
  ++made_;
  touch({u, v, a, b});
  mesh_->triangles[left] = {u, b, a};
  mesh_->triangles[right] = {v, a, b};
  link(3 * left, ub);
  link(3 * left + 1, 3 * right + 1);
  link(3 * left + 2, au);
  link(3 * right, va);
  link(3 * right + 2, bv);
  out_[u] = 3 * left;
  out_[v] = 3 * right;
  out_[a] = 3 * left + 2;
  out_[b] = 3 * right + 2;
  return true;
}

int MeshEdits::replace(int v, const VertexBlend& from, const Vec3& x) {
  if (!can_replace(v, x)) return -1;
  ++made_;
  touch_fan(v);
  const int m = add_vertex(from, x);
  const int first = out_[v];
  for_each_out(v, [&](int out) { mesh_->triangles[out / 3][out % 3] = m; });
  out_[v] = -1;
  out_[m] = first;
  return m;
}

int MeshEdits::try_vertex(const Vec3& x, const Vec3& gradient, bool on_surface) {
  mesh_->position.push_back(x);
  mesh_->gradient.push_back(gradient);
  mesh_->unprojected.push_back(on_surface ? 0 : 1);
  return static_cast<int>(mesh_->vertex_count()) - 1;
}

void MeshEdits::discard_tried() {
  mesh_->position.resize(out_.size());
  mesh_->gradient.resize(out_.size());
  mesh_->unprojected.resize(out_.size());
}

bool MeshEdits::closes_rim(std::span<const int> removed, std::span<const Triangle> added) const {
  std::vector<int> gone(removed.begin(), removed.end());
  std::ranges::sort(gone);
  std::vector<std::pair<int, int>> edges;
  for (const Triangle& t : added)
    for (int c = 0; c < 3; ++c) edges.emplace_back(t[c], t[(c + 1) % 3]);
  std::ranges::sort(edges);
  return std::ranges::all_of(gone, [&](int t) {
    for (int h = 3 * t; h < 3 * t + 3; ++h)
      if (!std::ranges::binary_search(gone, twin_[h] / 3) &&
          !std::ranges::binary_search(edges, std::pair(origin(h), end(h))))
        return false;
    return true;
  });
}

/// The triangles at corners of the added ones that are not removed.
std::vector<Triangle> MeshEdits::staying_around(std::span<const int> removed,
                                                std::span<const Triangle> added) const {
  std::vector<int> gone(removed.begin(), removed.end()), around;
  std::ranges::sort(gone);
  for (const Triangle& t : added)
    for (const int v : t)
      if (is_alive(v)) for_each_out(v, [&](int h) { around.push_back(h / 3); });
  sort_unique(around);
  std::vector<Triangle> staying;
  for (const int t : around)
    if (!std::ranges::binary_search(gone, t)) staying.push_back(mesh_->triangles[t]);
  return staying;
}

std::vector<int> MeshEdits::misfits(std::span<const int> removed, std::span<const Triangle> added) const {
  std::vector<Triangle> all = staying_around(removed, added);
  const std::size_t first_added = all.size();
  all.insert(all.end(), added.begin(), added.end());
  const std::vector<int> twin = twins_of(all);
  std::vector<int> corners;
  for (const Triangle& t : all) corners.insert(corners.end(), t.begin(), t.end());
  std::ranges::sort(corners);
  std::vector<int> found;
  for (std::size_t t = first_added; t < all.size(); ++t)
    for (int h = static_cast<int>(3 * t); h < static_cast<int>(3 * t + 3); ++h) {
      const auto [first, last] = std::equal_range(corners.begin(), corners.end(), origin_of(all, h));
      if (twin[h] >= 0 && is_one_fan(twin, h, last - first)) continue;
      found.push_back(static_cast<int>(t - first_added));
      break;
    }
  return found;
}

bool MeshEdits::exchange(std::span<const int> removed, std::span<const Triangle> added,
                         std::span<const VertexBlend> from) {
  if (!closes_rim(removed, added) || !misfits(removed, added).empty()) return false;
  const std::size_t first_tried = out_.size();
  for (std::size_t v = first_tried; v < mesh_->vertex_count(); ++v)
    complete_vertex(*mesh_, v, from.empty() ? nullptr : &from[v - first_tried]);
  out_.resize(mesh_->vertex_count(), -1);
  touched_.resize(mesh_->vertex_count(), 0);
  ++made_;
  std::vector<int> open;
  take_out(removed, open);
  put_in(added, open);
  return true;
}

/// open: the half-edges along the rim of what was taken out.
void MeshEdits::take_out(std::span<const int> removed, std::vector<int>& open) {
  for (const int t : removed)
    for (int h = 3 * t; h < 3 * t + 3; ++h) {
      out_[origin(h)] = -1;
      touch({origin(h)});
      open.push_back(twin_[h]);
    }
  for (const int t : removed) mesh_->triangles[t] = kRemovedTriangle;
  std::erase_if(open, [&](int h) { return is_removed(h); });
}

void MeshEdits::put_in(std::span<const Triangle> added, std::vector<int>& open) {
  for (const Triangle& t : added) {
    const int first = 3 * add_triangle(t);
    for (int h = first; h < first + 3; ++h) open.push_back(h);
  }
  const auto edge = [&](int h) { return std::pair<int, int>(std::minmax({origin(h), end(h)})); };
  std::ranges::sort(open, [&](int g, int h) { return std::pair(edge(g), g) < std::pair(edge(h), h); });
  for (std::size_t i = 0; i < open.size(); i += 2) link(open[i], open[i + 1]);
  for (const int h : open) {
    out_[origin(h)] = h;
    touch({origin(h)});
  }
}

void MeshEdits::drop_removed_triangles() {
  std::vector<Triangle>& triangles = mesh_->triangles;
  std::vector<int> number(triangles.size());
  int kept = 0;
  for (std::size_t t = 0; t < triangles.size(); ++t) number[t] = triangles[t][0] < 0 ? -1 : kept++;
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (int c = 0; c < 3 && number[t] >= 0; ++c) {
      const int twin = twin_[3 * t + c];
      twin_[3 * number[t] + c] = 3 * number[twin / 3] + twin % 3;
    }
  std::erase(triangles, kRemovedTriangle);
  twin_.resize(3 * triangles.size());
  set_first_half_edges();
}

void MeshEdits::set_first_half_edges() {
  out_.assign(mesh_->vertex_count(), -1);
  for (int h = half_edges() - 1; h >= 0; --h) out_[origin(h)] = h;
}

}  // namespace kappaflow
