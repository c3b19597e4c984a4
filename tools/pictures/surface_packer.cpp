#include "tools/pictures/surface_packer.h"

#include <vtkBase64Utilities.h>
#include <zlib.h>

#include <algorithm>
#include <set>
#include <stdexcept>
#include <unordered_map>
#include <utility>

#include "tools/io/binary.h"

namespace kappaflow {
namespace {

constexpr int kNone = -1;

/// How a frame's vertices follow from those of the last.
struct VertexOrder {
  std::vector<int> source;  // of each vertex as it is written: its number in the surface
  std::vector<int> before;  // and in the last frame; kNone: it is new
};

VertexOrder vertex_order(const std::vector<std::int64_t>& last, const std::vector<std::int64_t>& now) {
  std::unordered_map<std::int64_t, int> place;
  for (std::size_t v = 0; v < now.size(); ++v) place.emplace(now[v], static_cast<int>(v));
  VertexOrder order;
  std::vector<char> taken(now.size());
  for (std::size_t v = 0; v < last.size(); ++v)
    if (const auto found = place.find(last[v]); found != place.end()) {
      order.source.push_back(found->second);
      order.before.push_back(static_cast<int>(v));
      taken[found->second] = 1;
    }
  for (std::size_t v = 0; v < now.size(); ++v)
    if (taken[v] == 0) order.source.push_back(static_cast<int>(v));
  order.before.resize(now.size(), kNone);
  return order;
}

/// The same triangle, from its smallest corner on.
Triangle from_smallest(Triangle t) {
  std::rotate(t.begin(), std::ranges::min_element(t), t.end());
  return t;
}

std::vector<Triangle> renumbered(const std::vector<Triangle>& triangles, const std::vector<int>& source) {
  std::vector<int> number(source.size());
  for (std::size_t v = 0; v < source.size(); ++v) number[source[v]] = static_cast<int>(v);
  std::vector<Triangle> result;
  result.reserve(triangles.size());
  for (const Triangle& t : triangles)
    result.push_back(from_smallest({number[t[0]], number[t[1]], number[t[2]]}));
  return result;
}

/// A bit for each entry, from the lowest of the first byte on.
void append_bits(std::string& bytes, const std::vector<char>& flags) {
  for (std::size_t i = 0; i < flags.size(); i += 8) {
    unsigned byte = 0;
    for (std::size_t k = 0; k < 8 && i + k < flags.size(); ++k)
      byte |= static_cast<unsigned>(flags[i + k]) << k;
    bytes += static_cast<char>(byte);
  }
}

void append_planes(std::string& bytes, const std::vector<std::uint32_t>& numbers, int planes) {
  for (int p = 0; p < planes; ++p)
    for (const std::uint32_t number : numbers) bytes += static_cast<char>(number >> (8 * p) & 0xff);
}

/// Small for small differences of either sign, which wrap around.
std::uint32_t folded(std::uint32_t difference, int bytes) {
  const int unused = 32 - 8 * bytes;
  const auto wrapped = static_cast<std::int32_t>(difference << unused) >> unused;
  return wrapped < 0 ? 2 * static_cast<std::uint32_t>(-wrapped) - 1 : 2 * static_cast<std::uint32_t>(wrapped);
}

void append_component(std::string& bytes, const PackedComponent& now, const PackedComponent* last,
                      const std::vector<int>& before) {
  std::vector<std::uint32_t> differences;
  std::uint32_t previous = 0;
  for (std::size_t v = 0; v < before.size(); ++v) {
    const std::uint32_t value = now.value[v],
                        expected = before[v] == kNone ? previous : last->value[before[v]];
    differences.push_back(folded(value - expected, now.bytes));
    previous = value;
  }
  append_planes(bytes, differences, now.bytes);
}

void append_triangles(std::string& bytes, const std::vector<Triangle>& triangles) {
  std::array<std::vector<std::uint32_t>, 3> corners;
  int previous = 0;
  for (const Triangle& t : triangles) {
    for (std::size_t c = 0; c < 3; ++c)
      corners[c].push_back(static_cast<std::uint32_t>(t[c] - (c == 0 ? previous : t[0])));
    previous = t[0];
  }
  for (const auto& corner : corners) append_planes(bytes, corner, 4);
}

/// Those of the last frame that are still there come first; flags says which. Their corners are numbered as
/// this frame's are.
std::vector<Triangle> ordered_triangles(const std::vector<Triangle>& last, const std::vector<int>& before,
                                        std::size_t last_vertices, const std::vector<Triangle>& now,
                                        std::vector<char>& flags) {
  std::vector<int> number(last_vertices, kNone);
  for (std::size_t v = 0; v < before.size(); ++v)
    if (before[v] != kNone) number[before[v]] = static_cast<int>(v);
  std::multiset<Triangle> left(now.begin(), now.end());
  std::vector<Triangle> ordered;
  for (const Triangle& t : last) {
    const Triangle here{number[t[0]], number[t[1]], number[t[2]]};  // still from the smallest on
    const auto found = left.find(here);
    flags.push_back(found != left.end());
    if (found == left.end()) continue;
    ordered.push_back(here);
    left.erase(found);
  }
  ordered.insert(ordered.end(), left.begin(), left.end());
  return ordered;
}

}  // namespace

std::string SurfacePacker::pack(const QuantisedSurface& surface) {
  const auto [source, before] = vertex_order(last_.id, surface.id);
  QuantisedSurface now;
  std::vector<char> vertex_stays(last_.id.size()), triangle_stays;
  for (const int v : before)
    if (v != kNone) vertex_stays[v] = 1;
  for (const int v : source) now.id.push_back(surface.id[v]);
  now.triangles = ordered_triangles(last_.triangles, before, last_.id.size(),
                                    renumbered(surface.triangles, source), triangle_stays);
  const auto stay = static_cast<std::size_t>(std::ranges::count(triangle_stays, 1));
  const std::vector<Triangle> fresh(now.triangles.begin() + static_cast<std::ptrdiff_t>(stay),
                                    now.triangles.end());

  std::string bytes;
  append(bytes, static_cast<std::uint32_t>(source.size()));
  append(bytes, static_cast<std::uint32_t>(fresh.size()));
  append_bits(bytes, vertex_stays);
  append_bits(bytes, triangle_stays);
  for (std::size_t c = 0; c < surface.components.size(); ++c) {
    PackedComponent& component = now.components.emplace_back();
    component.bytes = surface.components[c].bytes;
    for (const int v : source) component.value.push_back(surface.components[c].value[v]);
    append_component(bytes, component, last_.components.empty() ? nullptr : &last_.components[c], before);
  }
  append_triangles(bytes, fresh);
  last_ = std::move(now);
  return bytes;
}

std::string deflated(std::string_view bytes) {
  uLongf size = compressBound(bytes.size());
  std::string result(size, '\0');
  if (compress2(reinterpret_cast<Bytef*>(result.data()), &size, reinterpret_cast<const Bytef*>(bytes.data()),
                bytes.size(), Z_BEST_COMPRESSION) != Z_OK)
    throw std::runtime_error("zlib cannot compress");
  result.resize(size);
  return result;
}

std::string base64(std::string_view bytes) {
  std::string text((bytes.size() + 2) / 3 * 4, '\0');
  vtkBase64Utilities::Encode(reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size(),
                             reinterpret_cast<unsigned char*>(text.data()));
  return text;
}

}  // namespace kappaflow
