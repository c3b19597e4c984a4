// Images whose bodies become others, whose instants are not equally far apart, or whose lattice moves.
#include <numbers>

#include "tests/tools/distance_files.h"
#include "tests/tools/runs/track_case.h"
#include "tests/tools/text_table.h"
#include "tests/tools/vdb_writer.h"

namespace kappaflow {
namespace {

class TrackImages : public Track {
 protected:
  /// From where the box's motion takes rest positions by `time` [m].
  double box_error(const std::string& method, int frame, double time) const {
    return mean_error(method, frame, [time](const Vec3& x) { return TurningBox::position(x, time); });
  }
};

struct Ball {
  Vec3 centre;
  double radius;
  double volume() const { return 4.0 / 3 * std::numbers::pi * std::pow(radius, 3); }
};

/// Two balls of equal radius, less the lens that they share.
double volume_of_two(double radius, double apart) {
  const double height = std::max(0.0, radius - 0.5 * apart);
  return 2 * (Ball{Vec3::Zero(), radius}.volume() -
              std::numbers::pi / 3 * height * height * (3 * radius - height));
}

/// Two balls that meet and part again, and a small one beside them from frame 1 to frame 4.
struct MeetingBalls {
  static constexpr int kFrames = 11;
  static constexpr double kRadius = 0.25, kSmallRadius = 0.1;
  static double apart(int k) { return 0.3 + 0.08 * std::abs(k - (kFrames - 1) / 2); }
  static bool has_small(int k) { return k >= 1 && k <= 4; }
  static int pieces(int k) { return (apart(k) < 2 * kRadius ? 1 : 2) + (has_small(k) ? 1 : 0); }
  static double volume(int k) {
    return volume_of_two(kRadius, apart(k)) + (has_small(k) ? Ball{Vec3::Zero(), kSmallRadius}.volume() : 0);
  }
  static SignedDistances image(int k) {
    constexpr float kBand = 0.15F;  // as far as a solver knows its distances
    std::vector<Ball> balls{{{-0.5 * apart(k), 0, 0}, kRadius}, {{0.5 * apart(k), 0, 0}, kRadius}};
    if (has_small(k)) balls.push_back({{0, 0.6, 0}, kSmallRadius});
    SignedDistances image{
        .grid = {.origin = {-0.8, -0.4, -0.4}, .spacing = Vec3::Constant(0.05), .dims = {33, 25, 17}},
        .value = {}};
    for (int z = 0; z < image.grid.dims[2]; ++z)
      for (int y = 0; y < image.grid.dims[1]; ++y)
        for (int x = 0; x < image.grid.dims[0]; ++x) {
          float nearest = kBand;
          for (const Ball& ball : balls)
            nearest = std::min(
                nearest, static_cast<float>((image.grid.point(x, y, z) - ball.centre).norm() - ball.radius));
          image.value.push_back(std::max(nearest, -kBand));
        }
    return image;
  }
};

TEST_F(TrackImages, PiecesFollowTheTopologyOfTheirVolumes) {
  for (int k = 0; k < MeetingBalls::kFrames; ++k)
    file(fmt::format("phi_{}.vti", k), vti_of(MeetingBalls::image(k), 0.1 * k));
  for (const bool backward : {false, true}) {
    TrackOptions o = options_for("phi_*.vti", {"regional"});
    o.range.backward = backward;
    ASSERT_EQ(track(o), 0);
    for (const TextRow& row : read_table(folder / "out/metrics.csv")) {
      const int frame = std::stoi(row.at("frame")), k = backward ? MeetingBalls::kFrames - 1 - frame : frame;
      EXPECT_EQ(row.at("components"), std::to_string(MeetingBalls::pieces(k))) << k << backward;
      EXPECT_NEAR(std::stod(row.at("volume")), MeetingBalls::volume(k), 0.03 * MeetingBalls::volume(k)) << k;
      EXPECT_EQ(row.at("unprojected"), "0") << k;
    }
  }
}

TEST_F(TrackImages, InstantsNeedNotBeEquallyFarApart) {
  const std::vector<double> times{0, 0.04, 0.06, 0.16, 0.2};
  std::string entries;
  for (std::size_t k = 0; k < times.size(); ++k) {
    file(fmt::format("flow_{}.vti", k), vti_of(image_of_box(times[k], true), times[k]));
    file(fmt::format("phi_{}.vti", k), vti_of(image_of_box(times[k], false), times[k]));
    file(fmt::format("m_{}.obj", k), obj_of_box(times[k], 0.05));
    entries += fmt::format("<DataSet timestep=\"{}\" file=\"m_{}.obj\"/>", times[k], k);
  }
  file("m.pvd", "<VTKFile type=\"Collection\"><Collection>" + entries + "</Collection></VTKFile>");
  struct Case {
    const char *pattern, *method;
    double error;
  };
  for (const auto& [pattern, method, error] : std::vector<Case>{{"flow_*.vti", "material", 0.0005},
                                                                {"phi_*.vti", "regional", 0.008},
                                                                {"m.pvd", "regional", 0.006}}) {
    ASSERT_EQ(track(options_for(pattern, {method})), 0);
    const auto rows = read_table(folder / "out/metrics.csv");
    for (std::size_t k = 0; k < times.size(); ++k) {
      EXPECT_DOUBLE_EQ(std::stod(rows[k].at("time")), times[k]) << pattern;
      EXPECT_NEAR(std::stod(rows[k].at("volume")), TurningBox::kVolume, 0.003) << pattern << " " << k;
      EXPECT_LT(box_error(method, static_cast<int>(k), times[k]), error) << pattern << " " << k;
    }
  }
}

// The lattice of a .vdb file is as large as its surface asks for.
TEST_F(TrackImages, LatticesOfVdbFilesMayMove) {
  constexpr int kFrames = 6;
  constexpr double kInterval = 0.06;
  std::array<int, 3> first{};
  bool same = true;
  for (int k = 0; k < kFrames; ++k) {
    const auto path = folder / fmt::format("phi_{}.vdb", k);
    if (!write_vdb(path, frame_of_box(kInterval * k))) GTEST_SKIP() << "built without OpenVDB";
    const ImageFrame frame = read_image(path);
    if (k == 0) first = frame.dims;
    same = same && frame.dims == first;
  }
  EXPECT_FALSE(same);
  ASSERT_EQ(track(options_for("phi_*.vdb", {"regional", "normal"})), 0);
  for (const TextRow& row : read_table(folder / "out/metrics.csv")) {
    EXPECT_NEAR(std::stod(row.at("volume")), TurningBox::kVolume, 0.003);
    EXPECT_EQ(row.at("components"), "1");
  }
  const double regional = box_error("regional", kFrames - 1, kInterval * (kFrames - 1));
  EXPECT_LT(regional, 0.015);
  EXPECT_GT(box_error("normal", kFrames - 1, kInterval * (kFrames - 1)), 4 * regional);
}

}  // namespace
}  // namespace kappaflow
