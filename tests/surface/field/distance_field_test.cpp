// Fields of distance images, against bodies whose distance is known.
#include "surface/field/distance_field.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>

#include "core/errors.h"
#include "surface/mesh/isosurface.h"
#include "surface/mesh/mesh_measures.h"
#include "tests/surface/mesh/ellipsoid_distance.h"

namespace kappaflow {
namespace {

using testing::ellipsoid_distance;
using testing::image_of;

std::shared_ptr<const DistanceImage> ellipsoid(const Vec3& semi_axes, double time, double spacing = 0.05) {
  return std::make_shared<DistanceImage>(
      image_of([&](const Vec3& x) { return ellipsoid_distance(semi_axes, x); }, 1.6, spacing), time);
}

std::shared_ptr<const DistanceImage> ball(const Vec3& centre, double radius, double time,
                                          double spacing = 0.05) {
  return std::make_shared<DistanceImage>(
      image_of([&](const Vec3& x) { return (x - centre).norm() - radius; }, 1.6, spacing), time);
}

/// A motion in the middle of four images of what make(time) returns, dt apart, about t = 0.
template <class Make>
DistanceMotion four_images(double dt, const Make& make) {
  return {make(-0.5 * dt), make(0.5 * dt), make(-1.5 * dt), make(1.5 * dt)};
}

const Vec3 kPlaces[] = {{0.8, 0.1, 0.2}, {-0.3, 0.7, 0.4}, {0.2, -0.5, 0.9}, {-0.6, -0.6, -0.3}};

// f = R - |x - u t|, with all its derivatives.
TEST(DistanceField, HasTheJetOfAMovingBall) {
  const Vec3 velocity(0.4, -0.3, 0.2);
  auto motion = four_images(0.02, [&](double t) { return ball(velocity * t, 0.9, t); });
  const auto field = motion.at(0);
  for (const Vec3& place : kPlaces) {
    const Vec3 x = place.normalized() * 0.9, n = x.normalized();
    const double r = x.norm();
    const Mat3 across = Mat3::Identity() - n * n.transpose();
    const Jet jet = field->jet(x);
    EXPECT_NEAR(jet.f, 0.9 - r, 1e-5);
    EXPECT_LT((jet.g + n).norm(), 1e-5);
    EXPECT_LT((jet.A + across / r).norm(), 1e-3);
    EXPECT_NEAR(jet.f_t, velocity.dot(n), 2e-5);
    EXPECT_LT((jet.g_t - across * velocity / r).norm(), 1e-3);
    const double along = velocity.dot(n);
    const Mat3 A_t = jet.C.contract(-velocity);
    EXPECT_LT((jet.A_t - A_t).norm(), 0.02) << "the body takes its Hessian along";
    EXPECT_NEAR(jet.C.contract(n).trace(), 2 / (r * r), 0.02);
    EXPECT_NEAR(along, jet.f_t, 2e-5);
  }
  EXPECT_NEAR(motion.displacement(), 0.02 * velocity.norm(), 0.0005);
}

// A body that is strained, u = E x, and whose distance is taken anew at each instant.
TEST(DistanceField, AnswersAStrainAsDistancesDo) {
  const Vec3 axes(1.1, 0.9, 1), rates(0.5, -0.2, -0.3);
  const Mat3 E = rates.asDiagonal();
  auto motion = four_images(0.02, [&](double t) {
    return ellipsoid(axes.cwiseProduct((t * rates).array().exp().matrix()), t, 0.05);
  });
  const auto field = motion.at(0);
  for (const Vec3& place : kPlaces) {
    const Vec3 direction = place.normalized();
    const Vec3 x = direction / direction.cwiseQuotient(axes).norm(), u = E * x;  // on the ellipsoid
    StrainResponse strain;
    const Jet jet = field->jet(x, strain);
    const auto along = [&](const Mat3& response) { return response.cwiseProduct(E).sum(); };
    EXPECT_NEAR(jet.f, 0, 1e-5);
    EXPECT_NEAR(jet.f_t + jet.g.dot(u), along(strain.f), 1e-4);
    const Vec3 g_rate = jet.g_t + jet.A * u + E * jet.g;
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(g_rate[c], along(strain.g[c]), 2e-3);
    const Mat3 A_rate = jet.A_t + jet.C.contract(u) + E * jet.A + jet.A * E;
    for (int c = 0, ce = 0; c < 3; ++c)
      for (int e = c; e < 3; ++e, ++ce) EXPECT_NEAR(A_rate(c, e), along(strain.A[ce]), 0.03);
  }
}

TEST(DistanceField, GoesThroughItsImages) {
  const auto radius = [](double t) { return 0.8 + 0.3 * t + 0.5 * t * t; };
  const auto image = [&](double t) { return ball(Vec3::Zero(), radius(t), t); };
  const Vec3 x(0.6, -0.5, 0.2);
  for (const bool with_before : {false, true})
    for (const bool with_after : {false, true}) {
      DistanceMotion motion(image(0.1), image(0.25), with_before ? image(0) : nullptr,
                            with_after ? image(0.3) : nullptr);
      EXPECT_NEAR(motion.at(0.1)->jet(x).f, radius(0.1) - x.norm(), 1e-5);
      EXPECT_NEAR(motion.at(0.25)->jet(x).f, radius(0.25) - x.norm(), 1e-5);
      if (!with_before && !with_after) continue;  // a parabola takes three
      EXPECT_NEAR(motion.at(0.15)->jet(x).f, radius(0.15) - x.norm(), 1e-5);
      EXPECT_NEAR(motion.at(0.15)->jet(x).f_t, 0.3 + 0.15, 1e-4);
    }
}

TEST(DistanceField, KnowsTheVelocitiesOfItsImages) {
  const auto image = [](double t) {
    SignedDistances distances = image_of([](const Vec3& x) { return x.norm() - 1; }, 1.6, 0.1);
    for (int k = 0; k < distances.grid.dims[2]; ++k)
      for (int j = 0; j < distances.grid.dims[1]; ++j)
        for (int i = 0; i < distances.grid.dims[0]; ++i) {
          const Vec3 x = distances.grid.point(i, j, k);
          distances.velocity.push_back(Vec3(-x.y() + t, x.x(), 0.5 * x.z()).cast<float>());
        }
    return std::make_shared<DistanceImage>(distances, t);
  };
  DistanceMotion motion(image(0), image(1));
  const auto velocity = motion.at(0.5)->material_velocity({0.6, 0.3, -0.4});
  ASSERT_TRUE(velocity);
  EXPECT_LT((*velocity - Vec3(0.2, 0.6, -0.2)).norm(), 1e-3);
  EXPECT_FALSE(four_images(1, [](double t) { return ball(Vec3::Zero(), 1, t); })
                   .at(0)
                   ->material_velocity(Vec3::Zero()));
}

// A tank half full: the image ends in the liquid.
TEST(DistanceField, EndsWhereItsImageDoes) {
  const SignedDistances tank = image_of([](const Vec3& x) { return x.z() - 0.25; }, 1, 0.05);
  const auto image = std::make_shared<DistanceImage>(tank, 0);
  DistanceMotion motion(image, std::make_shared<DistanceImage>(tank, 1));
  const TriangleMesh mesh = extract_isosurface(*motion.at(0), 0.05);
  const AreaAndVolume size = area_and_volume(mesh.position, mesh.triangles);
  EXPECT_NEAR(size.volume, 2 * 2 * 1.25, 0.02);
  EXPECT_NEAR(size.area, 2 * 4 + 4 * 2 * 1.25, 0.5) << "edges and corners are rounded by a spacing or two";
  EXPECT_EQ(mesh_topology(mesh.position, mesh.triangles).components, 1);
}

// What the cubes leave out has no surface.
TEST(DistanceField, SaysWhereItMayBePositive) {
  auto motion = four_images(0.1, [](double t) { return ball(Vec3(0.5, -0.4, 0.3), 0.5, t, 0.04); });
  const auto field = motion.at(0);
  const SampledField lattice = isosurface_lattice(*field, 0.04);
  const auto cubes = field->occupied_cubes(lattice, 8);
  ASSERT_TRUE(cubes);
  int all = 1;
  for (const int points : lattice.dims) all *= (points - 2) / 8 + 1;
  EXPECT_LT(static_cast<int>(cubes->size()), all / 4);
  const TriangleMesh mesh = extract_isosurface(*field, 0.04);
  EXPECT_NEAR(area_and_volume(mesh.position, mesh.triangles).volume, 4.0 / 3 * 3.14159 * 0.125, 0.005);
}

TEST(DistanceField, RefusesWhatIsNoImage) {
  SignedDistances image = image_of([](const Vec3& x) { return x.norm() - 1; }, 1.5, 0.25);
  const auto refused = [](const SignedDistances& bad) { EXPECT_THROW(DistanceImage(bad, 0), InvalidInput); };
  SignedDistances bad = image;
  bad.value.pop_back();
  refused(bad);
  bad = image;
  bad.value[7] = std::numeric_limits<float>::quiet_NaN();
  refused(bad);
  bad = image;
  bad.velocity.resize(3);
  refused(bad);
  bad = image;
  bad.grid.spacing.y() = 0;
  refused(bad);
  const auto at = [&](double t) { return std::make_shared<DistanceImage>(image, t); };
  EXPECT_THROW(DistanceMotion(at(1), at(1)), InvalidInput);
  EXPECT_THROW(DistanceMotion(at(1), at(2), at(1.5)), InvalidInput);
  EXPECT_THROW(DistanceMotion(at(1), at(2)).at(2.5), InvalidInput);
}

}  // namespace
}  // namespace kappaflow
