#include "tools/pictures/shadow.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <span>

#include "core/parallel.h"

namespace kappaflow {
namespace {

constexpr double kSoftness = 0.16;  // radius of the light over its distance
constexpr double kLift = 1.5;       // above the surface that a place is looked up for [pixels of the light's]
constexpr double kLeast = 0.02;     // depth before a place that hides it: less is the surface itself
constexpr int kSearched = 16, kTaken = 32;  // places around a pixel's that are asked for what hides the light
constexpr double kMostReach = 0.2;          // of the light's image
constexpr int kWide = 4;  // pixels over which a normal is taken: triangles are not to be seen
constexpr double kGoldenAngle = 2.399963229728653;

/// In [0, 2 pi), different for neighbouring pixels: what too few places leave looks like paper, not like
/// bands.
double turn_at(int x, int y) {
  const double inner = 0.06711056 * x + 0.00583715 * y, outer = 52.9829189 * (inner - std::floor(inner));
  return 2 * std::numbers::pi * (outer - std::floor(outer));
}

/// Places on a disc of radius 1, spread evenly.
template <int kCount>
const std::array<Vec2, kCount>& disc() {
  static const auto places = [] {
    std::array<Vec2, kCount> result;
    for (int k = 0; k < kCount; ++k)
      result[static_cast<std::size_t>(k)] =
          std::sqrt((k + 0.5) / kCount) * Vec2(std::cos(k * kGoldenAngle), std::sin(k * kGoldenAngle));
    return result;
  }();
  return places;
}

/// What the camera sees, as places.
class SeenPlaces {
 public:
  explicit SeenPlaces(const DepthImage& image) : image_(image), to_place_(image.to_image.inverse()) {}

  /// None outside of the image and where nothing is.
  std::optional<Vec3> at(int x, int y) const {
    if (x < 0 || y < 0 || x >= image_.width || y >= image_.height) return std::nullopt;
    const float depth = image_.depth[static_cast<std::size_t>(y) * static_cast<std::size_t>(image_.width) +
                                     static_cast<std::size_t>(x)];
    if (!(depth < 1)) return std::nullopt;
    const Eigen::Vector4d place =
        to_place_ * Eigen::Vector4d(2 * (x + 0.5) / image_.width - 1, 2 * (y + 0.5) / image_.height - 1,
                                    2.0 * depth - 1, 1);
    return place.head<3>() / place.w();
  }

  /// Towards the viewer.
  Vec3 normal_at(int x, int y, const Vec3& place) const {
    return shorter(at(x + kWide, y), at(x - kWide, y), place)
        .cross(shorter(at(x, y + kWide), at(x, y - kWide), place))
        .normalized();
  }

 private:
  /// From one side or to the other: the nearer one is of the same surface.
  static Vec3 shorter(const std::optional<Vec3>& after, const std::optional<Vec3>& before,
                      const Vec3& place) {
    const Vec3 none = Vec3::Constant(HUGE_VAL), forward = after ? Vec3(*after - place) : none,
               backward = before ? Vec3(place - *before) : none;
    const Vec3& chosen = forward.squaredNorm() < backward.squaredNorm() ? forward : backward;
    return chosen.allFinite() ? chosen : Vec3::Zero();
  }

  const DepthImage& image_;
  Eigen::Matrix4d to_place_;
};

/// How much of a disc of light places see.
class DiscLight {
 public:
  explicit DiscLight(const DepthImage& image)
      : image_(image),
        pixels_per_metre_(0.5 * image.width * image.to_image.row(0).head<3>().norm()),
        depth_per_metre_(0.5 * image.to_image.row(2).head<3>().norm()) {}

  double pixel() const { return 1 / pixels_per_metre_; }  ///< [m]

  /// 0 to 1.
  double seen_from(const Vec3& place, double turn) const {
    const Eigen::Vector4d in_box = image_.to_image * place.homogeneous();
    const Spot spot{0.5 * (in_box.x() + 1) * image_.width, 0.5 * (in_box.y() + 1) * image_.height,
                    0.5 * (in_box.z() + 1)};
    const double reach = std::min(penumbra(spot.depth), kMostReach * image_.width);
    const Vec2 along(std::cos(turn), std::sin(turn));
    double depths = 0;
    const int hiding = hiding_around(spot, disc<kSearched>(), reach * along, depths);
    if (hiding == 0) return 1;
    const double radius = std::max(1.5, penumbra(spot.depth - depths / hiding));
    return 1 - static_cast<double>(hiding_around(spot, disc<kTaken>(), radius * along, depths)) / kTaken;
  }

 private:
  struct Spot {
    double x, y, depth;
  };

  /// Radius of a point's shadow at that depth behind it [pixels].
  double penumbra(double depth) const {
    return kSoftness * std::max(depth, 0.0) / depth_per_metre_ * pixels_per_metre_;
  }

  /// How many of the disc's places are before the spot, and the sum of their depths. The disc is turned and
  /// enlarged so that (1, 0) comes to `along`.
  int hiding_around(const Spot& spot, std::span<const Vec2> places, const Vec2& along, double& depths) const {
    int hiding = 0;
    depths = 0;
    for (const Vec2& place : places) {
      const double depth = depth_at(spot.x + place.x() * along.x() - place.y() * along.y(),
                                    spot.y + place.x() * along.y() + place.y() * along.x());
      if (!(depth < spot.depth - kLeast)) continue;
      ++hiding;
      depths += depth;
    }
    return hiding;
  }

  double depth_at(double x, double y) const {
    if (!(x >= 0) || !(y >= 0) || x >= image_.width || y >= image_.height) return HUGE_VAL;
    const float depth = image_.depth[static_cast<std::size_t>(y) * static_cast<std::size_t>(image_.width) +
                                     static_cast<std::size_t>(x)];
    return depth < 1 ? depth : HUGE_VAL;
  }

  const DepthImage& image_;
  double pixels_per_metre_, depth_per_metre_;
};

/// What is left of a colour where that much of the key light is seen.
double left_of(double seen, const Vec3& normal, const Lighting& lighting) {
  const double key = lighting.from_key * std::max(0.0, normal.dot(lighting.key)),
               fill = lighting.from_fill * std::max(0.0, normal.dot(lighting.fill));
  return 1 - (1 - seen) * key / (lighting.ambient + fill + key);
}

}  // namespace

void cast_shadows(vtkImageData& picture, const DepthImage& seen, const DepthImage& from_key,
                  const Lighting& lighting) {
  const SeenPlaces places(seen);
  const DiscLight light(from_key);
  const double lift = kLift * light.pixel();
  auto* const colours = static_cast<unsigned char*>(picture.GetScalarPointer(0, 0, 0));
  const auto darken = [&](int x, int y) {
    const std::optional<Vec3> place = places.at(x, y);
    if (!place) return;
    const Vec3 normal = places.normal_at(x, y, *place);
    const double visible = light.seen_from(*place + lift * (normal + lighting.key), turn_at(x, y));
    if (visible == 1) return;
    const double left = left_of(visible, normal, lighting);
    unsigned char* const colour = colours + 3 * (static_cast<std::ptrdiff_t>(y) * seen.width + x);
    std::transform(colour, colour + 3, colour,
                   [&](unsigned char c) { return static_cast<unsigned char>(std::lround(left * c)); });
  };
  parallel_for(
      static_cast<std::size_t>(seen.height),
      [&](std::size_t y) {
        for (int x = 0; x < seen.width; ++x) darken(x, static_cast<int>(y));
      },
      8);
}

}  // namespace kappaflow
