// Velocity errors at one instant on bodies of particles in known motions.
#include <gtest/gtest.h>

#include "tests/surface/motion/surface_points.h"
#include "tests/surface/reference_data.h"

namespace kappaflow {
namespace {

using testing::surface_points;
using testing::velocities_at;

/// The affine motion u + G x.
struct Motion {
  Vec3 u = Vec3::Zero();
  Mat3 G = Mat3::Zero();
  Vec3 at(const Vec3& x) const { return u + G * x; }
};

Mat3 matrix(std::initializer_list<double> rows) {
  return Eigen::Map<const Mat3>(rows.begin()).transpose();
}

const Motion kTranslation{.u = Vec3(1, 0, 0)};
const Motion kRotation{.G = matrix({0, -1, 0, 1, 0, 0, 0, 0, 0})};
const Motion kShear{.G = matrix({0, 1, 0, 0, 0, 0, 0, 0, 0})};
const Motion kStretch{.G = matrix({1, 0, 0, 0, -0.5, 0, 0, 0, -0.5})};

/// RMS error of the method over the RMS velocity, on points spread evenly over the body's surface; points
/// where the method's confidence is less than `least_confidence` are left out.
double relative_error(const testing::Body& at_rest, const Motion& motion, std::string_view method,
                      const VelocityOptions& options, double least_confidence = 0) {
  testing::Body body = at_rest;
  testing::set_velocities(body.particles, [&](const Vec3& x) { return motion.at(x); });
  const ParticleField field(body.particles, body.threshold, 0);
  const std::vector<Vec3> points = surface_points(field, 1500, 1);
  const SurfaceVelocities result = velocities_at(field, method, points, options);
  double error = 0, size = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (result.confidence[i] < least_confidence) continue;
    error += (result.velocity[i] - motion.at(points[i])).squaredNorm();
    size += motion.at(points[i]).squaredNorm();
  }
  EXPECT_GT(size, 0);
  return std::sqrt(error / size);
}

struct Row {
  const char* name;
  Motion motion;
  double normal, total, curvature_only, curvature;
};

// The figures of an independent prototype on the vertices of an isosurface of this body. Its damping for
// these is not on record: 0.05 with a limit of 4 fits all of them. Here the points are spread by area and the
// directions of the motions are chosen anew, hence the tolerance.
TEST(BodyOf175, ErrorsOfEveryMethodAreThoseOfAnIndependentPrototype) {
  const Row rows[] = {{"translation", kTranslation, 0.86, 0.19, 0.17, 0.016},
                      {"rotation", kRotation, 0.99, 1.92, 0.21, 0.43},
                      {"shear", kShear, 0.91, 1.69, 1.39, 0.74},
                      {"stretch", kStretch, 0.80, 1.56, 2.08, 1.21}};
  const testing::Body body = testing::read_body175();
  for (const Row& row : rows) {
    const auto expect_near = [&](std::string_view method, double expected) {
      const double error = relative_error(body, row.motion, method, {.damping = 0.05, .speed_limit = 4});
      EXPECT_NEAR(error, expected, 0.14 * expected + 0.005) << row.name << ", " << method;
    };
    expect_near("normal", row.normal);
    expect_near("total", row.total);
    expect_near("curvature-only", row.curvature_only);
    expect_near("curvature", row.curvature);
  }
}

// The ridge leaves about a hundredth of an affine motion out at a surface, where the particles in reach lie
// to one side. Under strain the surface of Eq. 12 moves along its normal a little otherwise than the material
// (Eq. 4).
TEST(BodyOf175, MaterialVelocityFollowsEveryMotion) {
  const testing::Body body = testing::read_body175();
  EXPECT_LT(relative_error(body, kTranslation, "material", {}), 1e-12);
  EXPECT_LT(relative_error(body, kRotation, "material", {}), 0.015);
  EXPECT_LT(relative_error(body, kShear, "material", {}), 0.06);
  EXPECT_LT(relative_error(body, kStretch, "material", {}), 0.07);
}

// Curvature knows nothing of the caps that one particle alone makes, of which the body of seven has many.
constexpr double kDetermined = 1 - 1e-6;
constexpr VelocityOptions kRigid{.damping = 1e-6, .speed_limit = 4};

TEST(RigidBodies, TranslationIsExactForEveryMethodThatKnowsTheTangent) {
  for (const testing::Body& body : {testing::read_body175(), testing::read_body_of_seven()}) {
    for (const auto* method : {"total", "curvature", "material"})
      EXPECT_LT(relative_error(body, kTranslation, method, kRigid), 1e-4) << method;
    EXPECT_LT(relative_error(body, kTranslation, "curvature-only", kRigid, kDetermined), 1e-4);
  }
}

TEST(RigidBodies, RotationIsExactForCurvatureInvarianceAlone) {
  for (const testing::Body& body : {testing::read_body175(), testing::read_body_of_seven()}) {
    EXPECT_LT(relative_error(body, kRotation, "curvature-only", kRigid, kDetermined), 1e-4);
    // Total velocity contradicts a rotation, so the sum of Eq. 10 is better than total and not exact.
    const double total = relative_error(body, kRotation, "total", kRigid);
    const double both = relative_error(body, kRotation, "curvature", kRigid);
    EXPECT_GT(total, 1);
    EXPECT_LT(both, total);
    EXPECT_GT(both, 0.05);
  }
}

}  // namespace
}  // namespace kappaflow
