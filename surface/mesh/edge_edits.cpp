#include "surface/mesh/edge_edits.h"

#include <algorithm>
#include <numeric>

#include "core/errors.h"
#include "core/parallel.h"

namespace kappaflow {

int heaviest(const VertexBlend& from) {
  return from.vertex[std::ranges::max_element(from.weight) - from.weight.begin()];
}

void EdgeEdits::start(TriangleMesh& mesh) {
  mesh_ = &mesh;
  history_.vertices_at_start = static_cast<int>(mesh.vertex_count());
  out_.assign(mesh.vertex_count(), -1);
  mark_.assign(mesh.vertex_count(), 0);
  question_ = 0;
  set_twins();
}

/// Half-edges are sorted by their origin; each looks for its twin among those of its end.
void EdgeEdits::set_twins() {
  const int n = static_cast<int>(3 * mesh_->triangles.size());
  start_.assign(mesh_->vertex_count() + 1, 0);
  for (int h = 0; h < n; ++h) ++start_[origin(h) + 1];
  std::partial_sum(start_.begin(), start_.end(), start_.begin());
  outgoing_.resize(n);
  for (int h = n - 1; h >= 0; --h) {
    out_[origin(h)] = h;
    outgoing_[--start_[origin(h) + 1]] = {end(h), h};
  }
  // start_[v + 1] has moved down to where the half-edges of v begin.
  twin_.resize(n);
  parallel_for(twin_.size(), [&](std::size_t i) {
    const int h = static_cast<int>(i), v = end(h),
              last = v + 2 < static_cast<int>(start_.size()) ? start_[v + 2] : n;
    const auto* const found = std::find_if(outgoing_.data() + start_[v + 1], outgoing_.data() + last,
                                           [&](const auto& other) { return other.first == origin(h); });
    twin_[h] = found == outgoing_.data() + last ? -1 : found->second;
  });
  if (const auto open = std::ranges::find(twin_, -1); open != twin_.end())
    throw TopologyError(mesh_->position[end(static_cast<int>(open - twin_.begin()))],
                        "a mesh to be edited is not closed here");
}

void EdgeEdits::finish() {
  alive_.resize(out_.size());
  for (std::size_t v = 0; v < out_.size(); ++v) alive_[v] = out_[v] >= 0;
  remove_dead(alive_, *mesh_, history_);
  mesh_ = nullptr;
}

int EdgeEdits::valence(int v) const {
  int n = 0;
  for_each_out(v, [&](int) { ++n; });
  return n;
}

int EdgeEdits::find(int u, int v) const {
  if (!is_alive(u) || !is_alive(v)) return -1;
  int found = -1;
  for_each_out(u, [&](int h) {
    if (end(h) == v) found = h;
  });
  return found;
}

void EdgeEdits::link(int h, int twin) {
  twin_[h] = twin;
  twin_[twin] = h;
}

int EdgeEdits::add_vertex(const VertexBlend& attributes, const Vec3& x) {
  mesh_->position.push_back(x);
  mesh_->rest_position.push_back(blended(mesh_->rest_position, attributes));
  mesh_->source.push_back(mesh_->source[heaviest(attributes)]);
  mesh_->unprojected.push_back(0);
  mesh_->id.push_back(mesh_->next_id++);
  out_.push_back(-1);
  mark_.push_back(0);
  return static_cast<int>(out_.size()) - 1;
}

int EdgeEdits::add_triangle(const Triangle& triangle) {
  mesh_->triangles.push_back(triangle);
  twin_.resize(twin_.size() + 3, -1);
  return static_cast<int>(mesh_->triangles.size()) - 1;
}

int EdgeEdits::split(int h, double share, const Vec3& x) {
  const int t = twin_[h], u = origin(h), v = end(h), a = apex(h), b = apex(t);
  const int va = twin_[next(h)], au = twin_[previous(h)], ub = twin_[next(t)], bv = twin_[previous(t)];
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

int EdgeEdits::split(int triangle, const VertexBlend& attributes, const Vec3& x) {
  const auto [a, b, c] = mesh_->triangles[triangle];
  const int first = 3 * triangle, bc = twin_[first + 1], ca = twin_[first + 2];
  const int m = add_vertex(attributes, x), second = 3 * add_triangle({b, c, m}),
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

bool EdgeEdits::can_collapse(int h) {
  const int u = origin(h), v = end(h);
  if (valence(apex(h)) <= 3 || valence(apex(twin_[h])) <= 3) return false;
  ++question_;
  for_each_out(u, [&](int out) { mark_[end(out)] = question_; });
  int common = 0;
  for_each_out(v, [&](int out) { common += mark_[end(out)] == question_; });
  return common == 2;
}

void EdgeEdits::collapse(int h) {
  const int t = twin_[h], u = origin(h), v = end(h), a = apex(h), b = apex(t);
  const int va = twin_[next(h)], au = twin_[previous(h)], ub = twin_[next(t)], bv = twin_[previous(t)];
  for_each_out(u, [&](int out) { mesh_->triangles[out / 3][out % 3] = v; });
  link(va, au);
  link(ub, bv);
  mesh_->triangles[h / 3] = kRemovedTriangle;
  mesh_->triangles[t / 3] = kRemovedTriangle;
  out_[u] = -1;
  out_[v] = au;
  out_[a] = va;
  out_[b] = ub;
}

bool EdgeEdits::flip(int h) {
  const int t = twin_[h], u = origin(h), v = end(h), a = apex(h), b = apex(t);
  if (valence(u) <= 3 || valence(v) <= 3 || find(a, b) >= 0) return false;
  const int va = twin_[next(h)], au = twin_[previous(h)], ub = twin_[next(t)], bv = twin_[previous(t)];
  const int left = h / 3, right = t / 3;
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

int EdgeEdits::replace(int v, const VertexBlend& attributes, const Vec3& x) {
  const int m = add_vertex(attributes, x);
  const int first = out_[v];
  for_each_out(v, [&](int out) { mesh_->triangles[out / 3][out % 3] = m; });
  out_[v] = -1;
  out_[m] = first;
  return m;
}

}  // namespace kappaflow
