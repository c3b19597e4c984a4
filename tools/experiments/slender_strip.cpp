#include "tools/experiments/slender_strip.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <span>
#include <vector>

#include "core/errors.h"
#include "core/types.h"

namespace kappaflow {
namespace {

constexpr int kSegments = 100;           // segments over the height, at the slot
constexpr int kStepsPerSegment = 4;      // time steps
constexpr double kWatched = 0.55;        // how far below the slot the strip is watched, in heights
constexpr int kSkipped = 2, kFolds = 5;  // there and back: first ones, and those that count
constexpr double kLongest = 20;          // times the fall at the slot's speed
constexpr double kOffset = 0.02;  // of the first node, in thicknesses: else it would never know where to fold

/// A symmetric positive definite system whose entries further than kBand from the diagonal are zero.
class BandedSystem {
 public:
  static constexpr std::size_t kBand = 5;

  explicit BandedSystem(std::size_t size) : rows_(size), values_(size, 0) {}

  /// Of the lower triangle.
  double& entry(std::size_t row, std::size_t column) { return rows_[row][row - column]; }
  double& value(std::size_t row) { return values_[row]; }

  /// Cholesky's factors without roots, L D L^T, in place; value() is then the solution.
  void solve() {
    for (std::size_t i = 0; i < rows_.size(); ++i) factor(i);
    for (std::size_t i = 0; i < rows_.size(); ++i)
      for (std::size_t d = 1; d <= reach(i); ++d) values_[i] -= rows_[i][d] * values_[i - d];
    for (std::size_t i = 0; i < rows_.size(); ++i) values_[i] /= rows_[i][0];
    for (std::size_t i = rows_.size(); i-- > 0;)
      for (std::size_t d = 1; d <= reach(i); ++d) values_[i - d] -= rows_[i][d] * values_[i];
  }

 private:
  static std::size_t reach(std::size_t row) { return std::min(kBand, row); }

  void factor(std::size_t i) {
    for (std::size_t d = reach(i); d > 0; --d) {
      const std::size_t j = i - d;
      double sum = rows_[i][d];
      for (std::size_t e = d + 1; e <= reach(i); ++e) sum -= rows_[i][e] * rows_[i - e][0] * rows_[j][e - d];
      rows_[i][d] = sum / rows_[j][0];
    }
    for (std::size_t d = 1; d <= reach(i); ++d) rows_[i][0] -= rows_[i][d] * rows_[i][d] * rows_[i - d][0];
  }

  std::vector<std::array<double, kBand + 1>> rows_;
  std::vector<double> values_;
};

/// The strip as nodes, the first that left the slot first; the slot is the origin, y is up.
class Strip {
 public:
  explicit Strip(const FallingStrip& strip)
      : strip_(strip),
        length_(strip.height / kSegments),
        step_(length_ / (kStepsPerSegment * strip.speed)),
        volume_(strip.thickness * strip.width * length_) {}

  double time() const { return time_; }

  /// Where the strip is at the watched depth, from the slot down, or nothing before it lies on the plate.
  std::optional<double> watched() const {
    if (laid_ == 0) return std::nullopt;
    const double depth = -kWatched * strip_.height;
    std::size_t k = place_.size() - 1;
    while (k > 0 && place_[k].y() > depth) --k;
    const Vec2 down = place_[k], up = place_[k + 1];
    return down.x() + (up.x() - down.x()) * (depth - down.y()) / (up.y() - down.y());
  }

  void step() {
    emit();
    measure();
    accelerate();
    for (std::size_t k = laid_; k < place_.size(); ++k) place_[k] += step_ * velocity_[k];
    time_ += step_;
    land();
  }

 private:
  /// Two nodes or three above the slot are led, so that the strip leaves it straight.
  void emit() {
    const auto height = [&] { return static_cast<double>(place_.size()) * length_ - strip_.speed * time_; };
    for (; height() < 2.5 * length_; velocity_.emplace_back(0, -strip_.speed))
      place_.emplace_back(place_.empty() ? kOffset * strip_.thickness : 0, height());
    free_end_ = place_.size();
    while (free_end_ > laid_ && place_[free_end_ - 1].y() >= 0) --free_end_;
  }

  void measure() {
    along_.resize(place_.size() - 1);
    segment_.resize(place_.size() - 1);
    for (std::size_t k = std::max<std::size_t>(laid_, 2) - 2; k + 1 < place_.size(); ++k) {
      const Vec2 d = place_[k + 1] - place_[k];
      segment_[k] = d.norm();
      along_[k] = d / segment_[k];
    }
  }

  /// How fast segment k turns is the difference of its ends' velocities times this.
  Vec2 turning(std::size_t k) const { return Vec2(-along_[k].y(), along_[k].x()) / segment_[k]; }

  /// Adds the resistance r to the rate sum_n a_n . v_n of the nodes from `first` on: step r a a^T.
  void resist(BandedSystem& system, double r, std::size_t first, std::span<const Vec2> a) const {
    for (std::size_t m = 0; m < a.size(); ++m)
      for (std::size_t n = 0; n < a.size(); ++n) {
        const std::size_t row = first + m, column = first + n;
        if (!is_free(row)) continue;
        for (int c = 0; c < 2; ++c) {
          const double factor = step_ * r * a[m][c];
          if (!is_free(column)) system.value(at(row, c)) -= factor * a[n].dot(velocity_[column]);
          for (int e = 0; e < 2 && is_free(column) && at(column, e) <= at(row, c); ++e)
            system.entry(at(row, c), at(column, e)) += factor * a[n][e];
        }
      }
  }

  void accelerate() {
    if (free_end_ == laid_) return;
    BandedSystem system(2 * (free_end_ - laid_));
    for (std::size_t k = laid_; k < free_end_; ++k)
      for (int c = 0; c < 2; ++c) {
        system.entry(at(k, c), at(k, c)) = volume_;
        system.value(at(k, c)) = volume_ * (velocity_[k][c] - (c == 1 ? strip_.gravity * step_ : 0));
      }
    const double trouton = 3 * strip_.viscosity;
    for (std::size_t k = laid_ > 0 ? laid_ - 1 : 0; k <= free_end_; ++k) {
      const double section = volume_ / segment_[k];
      resist(system, trouton * section / segment_[k], k, std::array{Vec2(-along_[k]), along_[k]});
      if (k == 0) continue;
      const double length = (segment_[k - 1] + segment_[k]) / 2, mean = volume_ / length;
      const double inertia = mean * mean * strip_.thickness / strip_.width / 12;
      const Vec2 below = turning(k - 1), above = turning(k);
      resist(system, trouton * inertia / length, k - 1, std::array{below, Vec2(-below - above), above});
    }
    system.solve();
    for (std::size_t k = laid_; k < free_end_; ++k)
      velocity_[k] = Vec2(system.value(at(k, 0)), system.value(at(k, 1)));
  }

  /// Nodes that have reached the plate stay there, and so does what came before them.
  void land() {
    std::size_t landed = laid_;
    for (std::size_t k = laid_; k < free_end_; ++k)
      if (place_[k].y() <= -strip_.height) landed = k + 1;
    for (; laid_ < landed; ++laid_) velocity_[laid_] = Vec2::Zero();
  }

  bool is_free(std::size_t node) const { return node >= laid_ && node < free_end_; }
  std::size_t at(std::size_t node, int component) const {
    return 2 * (node - laid_) + static_cast<std::size_t>(component);
  }

  FallingStrip strip_;
  double length_, step_, volume_, time_ = 0;
  std::size_t laid_ = 0, free_end_ = 0;  // the nodes between them move freely
  std::vector<Vec2> place_, velocity_, along_;
  std::vector<double> segment_;
};

}  // namespace

double folding_frequency(const FallingStrip& strip) {
  Strip shape(strip);
  std::vector<double> passes;  // to the right
  std::optional<double> last;
  while (passes.size() <= kSkipped + kFolds) {
    if (shape.time() > kLongest * strip.height / strip.speed)
      throw InvalidInput("the slender strip does not fold with these numbers");
    shape.step();
    const std::optional<double> now = shape.watched();
    if (last && *last < 0 && *now >= 0) passes.push_back(shape.time());
    last = now;
  }
  return 2 * std::numbers::pi * kFolds / (passes.back() - passes[kSkipped]);
}

}  // namespace kappaflow
