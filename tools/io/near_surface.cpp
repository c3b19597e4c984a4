#include "tools/io/near_surface.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <numbers>
#include <optional>
#include <unordered_map>
#include <utility>

#include "core/errors.h"
#include "core/parallel.h"
#include "surface/field/particle_motion.h"
#include "surface/field/particle_weights.h"
#include "tools/io/liquid_depth.h"

namespace kappaflow {
namespace {

namespace fs = std::filesystem;

/// Chooses particles, piece after piece.
class Choice {
 public:
  Choice(const LiquidDepth& depth, std::span<const std::int64_t> before) : depth_(depth), before_(before) {}

  void add(InputFrame&& piece) {
    frame_.left_out += piece.left_out;
    frame_.all += piece.position.size();
    if (!frame_.time) frame_.time = piece.time;
    if (piece.position.empty()) return;
    frame_.id_name = piece.id_name;
    frame_.velocity_name = piece.velocity_name;
    frame_.radius_name = piece.radius_name;
    has_sources_ = has_sources_ && piece.source.size() == piece.position.size();
    if (!has_sources_)
      for (InputFrame* frame : {&piece, &frame_, &others_}) frame->source.clear();
    for (std::size_t i = 0; i < piece.position.size(); ++i) add(piece, i, depth_.zone(piece.position[i]));
  }

  /// Of particles that others have chosen, by the same lattice.
  void add_chosen(const InputFrame& chosen) {
    frame_.all += chosen.all;
    for (std::size_t i = 0; i < chosen.position.size(); ++i) add(chosen, i, chosen.zone[i]);
  }

  InputFrame result() {
    for (const auto& [cube, chosen] : of_cube_) {
      if (chosen.is_in_frame)
        frame_.zone[chosen.at] = chosen.zone;
      else
        in_use_.push_back(chosen);
    }
    std::ranges::sort(in_use_, {}, &Chosen::at);
    for (const Chosen& chosen : in_use_) copy(others_, chosen.at, frame_, chosen.zone);
    if (!std::ranges::all_of(frame_.temperature, [](float t) { return std::isfinite(t); }))
      frame_.temperature.clear();
    return std::move(frame_);
  }

 private:
  /// The particle that stands for a cube so far.
  struct Chosen {
    double squared_distance = 0;
    bool is_in_frame = false;  // else among the others
    std::size_t at = 0;
    Zone zone = Zone::deep;
  };

  void add(const InputFrame& piece, std::size_t i, Zone zone) {
    const Vec3& x = piece.position[i];
    if (zone < Zone::deep) {
      copy(piece, i, frame_, zone);
      return;
    }
    const bool was_before = !piece.id.empty() && std::ranges::binary_search(before_, piece.id[i]);
    const std::size_t at_end = frame_.position.size();
    if (was_before) copy(piece, i, frame_, Zone::passing);
    const auto [found, is_new] = of_cube_.try_emplace(depth_.cube(x, zone));
    Chosen& chosen = found->second;
    const double d2 = depth_.squared_distance_from_middle(x, zone);
    if (!is_new && !(d2 < chosen.squared_distance)) return;
    const std::optional<std::size_t> place =
        is_new || chosen.is_in_frame ? std::nullopt : std::optional(chosen.at);
    if (was_before)
      chosen = {d2, true, at_end, zone};
    else
      chosen = {d2, false, put(piece, i, place), zone};
  }

  /// Among the others, in place of the one there.
  std::size_t put(const InputFrame& piece, std::size_t i, std::optional<std::size_t> place) {
    if (!place) {
      copy(piece, i, others_, Zone::deep);
      return others_.position.size() - 1;
    }
    for_each_array(piece, others_, [&](const auto& from, auto& to) {
      if (!from.empty()) to[*place] = from[i];
    });
    return *place;
  }

  static void copy(const InputFrame& from, std::size_t i, InputFrame& to, Zone zone) {
    for_each_array(from, to, [&](const auto& values, auto& more) {
      if (!values.empty()) more.push_back(values[i]);
    });
    to.zone.push_back(zone);
  }

  const LiquidDepth& depth_;
  std::span<const std::int64_t> before_;
  InputFrame frame_, others_;
  std::unordered_map<std::uint64_t, Chosen> of_cube_;
  std::vector<Chosen> in_use_;
  bool has_sources_ = true;
};

/// In so many parts, whatever the number of threads.
LiquidDepth depth_of(std::span<const Vec3> position, double sigma, Ranks* ranks) {
  constexpr std::size_t kParts = 16;
  std::vector<LiquidDepth> part(kParts, LiquidDepth(sigma));
  parallel_for(
      kParts,
      [&](std::size_t p) {
        const std::size_t begin = p * position.size() / kParts, end = (p + 1) * position.size() / kParts;
        part[p].add(position.subspan(begin, end - begin));
      },
      1);
  for (std::size_t p = 1; p < kParts; ++p) part[0].add(std::exchange(part[p], LiquidDepth(sigma)));
  part[0].measure(ranks);
  return std::move(part[0]);
}

LiquidDepth depth_of(std::span<const fs::path> files, double sigma) {
  LiquidDepth depth(sigma);
  for_each_piece(files, [&](InputFrame&& piece) { depth.add(piece.position); });
  depth.measure();
  return depth;
}

/// As quantile() has it, of values that may be many.
double fast_speed_of(std::deque<double>& speed) {
  if (speed.empty()) return 0;
  const auto chosen =
      speed.begin() + static_cast<std::ptrdiff_t>(kShareOfFast * static_cast<double>(speed.size() - 1));
  std::nth_element(speed.begin(), chosen, speed.end());
  return *chosen;
}

/// Of those nearest to one of them.
std::optional<double> spacing_around(std::vector<Vec3> position, std::size_t centre) {
  constexpr std::size_t kMost = 20000;
  const Vec3 x = position[centre];
  if (position.size() > kMost) {
    std::ranges::nth_element(position, position.begin() + kMost, {},
                             [&](const Vec3& y) { return (y - x).squaredNorm(); });
    position.resize(kMost);
  }
  try {
    return particle_spacing(position);
  } catch (const InvalidInput&) {  // one particle, or half of them in one place
    return std::nullopt;
  }
}

}  // namespace

InputFrame read_near_surface(std::span<const fs::path> files, double sigma,
                             std::span<const std::int64_t> before) {
  LiquidDepth depth(sigma);
  std::deque<double> speed;  // grows without a copy
  for_each_piece(files, [&](InputFrame&& piece) {
    depth.add(piece.position);
    for (const Vec3& v : piece.velocity) speed.push_back(v.norm());
  });
  const double fast = fast_speed_of(speed);
  speed = std::deque<double>();
  depth.measure();
  Choice choice(depth, before);
  for_each_piece(files, [&](InputFrame&& piece) { choice.add(std::move(piece)); });
  InputFrame frame = choice.result();
  frame.fast_speed = fast;
  return frame;
}

InputFrame near_surface_of(InputFrame own, double sigma, Ranks* ranks) {
  const LiquidDepth depth = depth_of(own.position, sigma, ranks);
  Choice choice(depth, {});
  choice.add(std::move(own));
  InputFrame chosen = choice.result();
  if (ranks == nullptr) return chosen;
  const std::vector<std::size_t> counts = ranks->one_of_each(chosen.position.size());
  InputFrame of_all;
  of_all.all = ranks->sum(chosen.all);
  for_each_array(chosen, of_all, [&](const auto& from, auto& to) {
    const bool known = from.size() == chosen.position.size();  // where there are none, both
    if (ranks->sum(known ? 0 : 1) == 0) to = ranks->gathered_to_first(std::span(from), counts);
  });
  of_all.zone = ranks->gathered_to_first(std::span<const Zone>(chosen.zone), counts);
  if (ranks->rank() > 0) return {};
  Choice once(depth, {});  // of two ranks that have particles in a cube one is chosen
  once.add_chosen(of_all);
  return once.result();
}

double scale_of(Zone zone) {
  return zone == Zone::deepest ? 6 : zone == Zone::deep ? 3 : 1;
}

FrameContent content_of(std::span<const fs::path> files) {
  FrameContent content;
  std::optional<double> radius;
  for_each_piece(files, [&](InputFrame&& piece) {
    content.particles += piece.position.size();
    content.has_ids = content.has_ids || !piece.id.empty();
    content.has_velocities = content.has_velocities || !piece.velocity.empty();
    for (const double r : piece.radius) {
      content.has_several_radii = content.has_several_radii || r != radius.value_or(r);
      radius = r;
    }
  });
  return content;
}

double rough_spacing(std::span<const fs::path> files) {
  constexpr double kTolerance = 0.1;
  constexpr int kMostRounds = 4;
  std::optional<double> of_largest;  // piece
  std::size_t largest = 0;
  for_each_piece(files, [&](InputFrame&& piece) {
    if (piece.position.size() <= largest) return;
    const auto found = spacing_around(piece.position, piece.position.size() / 2);
    if (!found) return;
    of_largest = found;
    largest = piece.position.size();
  });
  const InvalidInput none({files.front().string()}, "has no spacing; say --sigma");
  if (!of_largest) throw none;
  double spacing = *of_largest;
  for (int round = 0; round < kMostRounds; ++round) {  // pieces that lie across one another are too thin
    const LiquidDepth depth = depth_of(files, 2 * spacing);
    if (depth.scattered()) break;
    const double expected = 64 * std::numbers::pi / 315 * 8,  // of (1 - r^2)^3 within two spacings
        correction = std::cbrt(expected / depth.inside());
    if (!(correction > 0)) throw none;
    if (std::abs(correction - 1) < kTolerance) break;
    spacing *= correction;
  }
  return spacing;
}

}  // namespace kappaflow
