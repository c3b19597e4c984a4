// Images of distances and closed meshes, tracked, against a body whose motion is known.
#include <cmath>
#include <numbers>

#include "core/errors.h"
#include "tests/tools/distance_files.h"
#include "tests/tools/runs/track_case.h"
#include "tests/tools/text_table.h"

namespace kappaflow {
namespace {

namespace fs = std::filesystem;

constexpr double kInterval = 0.06;

class TrackDistances : public Track {
 protected:
  void write_images(bool with_velocities, double interval = kInterval) {
    for (int k = 0; k < kFrames; ++k)
      file(fmt::format("phi_{}.vti", k + 6),
           vti_of(image_of_box(interval * k, with_velocities), interval * k));
  }
  /// At the end, from where the box's motion takes rest positions [m].
  double box_error(const std::string& method) const {
    return mean_error(method, kFrames - 1,
                      [](const Vec3& x) { return TurningBox::position(x, kInterval * (kFrames - 1)); });
  }
  std::string refused(const TrackOptions& o) {
    return message_of<InvalidInput>([&] { track(o); });
  }
};

TEST_F(TrackDistances, ImagesAreFollowedByTheirDistanceAlone) {
  write_images(false);
  ASSERT_EQ(track(options_for("phi_*.vti", {"regional", "normal"})), 0);
  const double regional = box_error("regional"), normal = box_error("normal");
  EXPECT_LT(regional, 0.015);
  EXPECT_GT(normal, 4 * regional);
  for (const auto& row : read_table(folder / "out/metrics.csv")) {
    EXPECT_EQ(row.at("components"), "1");
    EXPECT_EQ(row.at("unprojected"), "0");
    EXPECT_EQ(row.at("particles"), "0");
    EXPECT_EQ(row.at("slip"), "");
    EXPECT_NEAR(std::stod(row.at("volume")), TurningBox::kVolume, 0.002);
  }
  EXPECT_FALSE(fs::exists(folder / "out/particles"));
  EXPECT_FALSE(fs::exists(folder / "out/particles.pvd"));
  EXPECT_EQ(bytes_of(folder / "out/run.pvd").find("particles"), std::string::npos);
}

TEST_F(TrackDistances, VelocitiesOfImagesAreTheMaterials) {
  write_images(true);
  TrackOptions o = options_for("phi_*.vti", {});
  o.metrics_interval = 1;
  ASSERT_EQ(track(o), 0);
  EXPECT_LT(box_error("material"), 0.003) << "the method where nobody names one";
  o.methods = {"regional"};
  ASSERT_EQ(track(o), 0);
  const auto row = read_table(folder / "out/metrics.csv").back();
  EXPECT_LT(std::stod(row.at("slip")), 0.25);
  EXPECT_NEAR(std::stod(row.at("rotation_captured")), 1, 0.1);
  EXPECT_LT(std::stod(row.at("tracer_distance")), 0.1);
}

TEST_F(TrackDistances, MeshesAreFollowedWhateverTheirVertices) {
  for (int k = 0; k < kFrames; ++k) file(fmt::format("m{}.obj", k), obj_of_box(kInterval * k));
  TrackOptions o = options_for("m*.obj", {"regional", "normal"});
  o.frames_per_second = 1 / kInterval;
  o.formats = {MeshFormat::usd};
  ASSERT_EQ(track(o), 0);
  EXPECT_LT(box_error("regional"), 0.02);
  EXPECT_GT(box_error("normal"), 3 * box_error("regional"));
  EXPECT_TRUE(fs::exists(folder / "out/run.usda"));
  EXPECT_FALSE(fs::exists(folder / "out/particles.usda"));
}

TEST_F(TrackDistances, OptionsOfParticlesAreRefused) {
  write_images(false);
  TrackOptions o = options_for("phi_*.vti", {"material"});
  EXPECT_EQ(refused(o), "phi: the velocity \"material\" takes images with velocities; these have none");
  o.methods = {"fresh-particles"};
  EXPECT_EQ(refused(o), "phi: the method \"fresh-particles\" is for particles; these are images");
  o.methods = {};
  o.sigma = 0.1;
  EXPECT_EQ(refused(o), "phi: --sigma is for particles; these are images");
  o.sigma.reset();
  o.threshold = 1;
  EXPECT_EQ(refused(o), "phi: --threshold is for particles; these are images");
  o.threshold.reset();
  o.weights = WeightRule::normalised;
  EXPECT_EQ(refused(o), "phi: --weights is for particles; these are images");
  o.weights = WeightRule::uniform;
  o.kernels = Kernels::anisotropic;
  EXPECT_EQ(refused(o), "phi: --kernels is for particles; these are images");
  o.kernels = Kernels::round;
  o.anchor = Anchor::particles;
  EXPECT_EQ(refused(o), "phi: --anchor is for particles; these are images");
  o.anchor = Anchor::none;
  o.edge_length = 2;
  EXPECT_EQ(refused(o), "--edge: found 2 m; expected 0.01 to 0.4 m, which is 0.05 to 2 sigma");
  EXPECT_FALSE(fs::exists(folder / "out"));
}

// Distances that end at 0.1 m do not say how a surface moves that goes further.
TEST_F(TrackDistances, TooLargeStepsAreRefused) {
  for (int k = 0; k < 3; ++k) {
    SignedDistances image = image_of_box(0.5 * k, false);
    for (float& d : image.value) d = std::clamp(d, -0.1F, 0.1F);
    file(fmt::format("phi_{}.vti", k), vti_of(image, 0.5 * k));
  }
  const std::string message = refused(options_for("phi_*.vti", {}));
  EXPECT_NE(message.find("phi_1.vti: the surface moves by "), std::string::npos) << message;
  EXPECT_NE(message.find("its distances reach 0.1 m; at most 0.5 of that is allowed"), std::string::npos)
      << message;
}

TEST_F(TrackDistances, PositiveInsideIsSeen) {
  for (int k = 0; k < 3; ++k) {
    SignedDistances image = image_of_box(kInterval * k, false);
    for (float& d : image.value) d = -d;
    file(fmt::format("phi_{}.vti", k), vti_of(image, kInterval * k));
  }
  ASSERT_EQ(track(options_for("phi_*.vti", {})), 0);
  EXPECT_NEAR(std::stod(read_table(folder / "out/metrics.csv").back().at("volume")), TurningBox::kVolume,
              0.002);
  EXPECT_NE(bytes_of(folder / "out/run.json").find("positive is taken for inside"), std::string::npos);
}

}  // namespace
}  // namespace kappaflow
