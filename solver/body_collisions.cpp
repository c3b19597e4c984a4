#include "solver/body_collisions.h"

#include <BulletCollision/Gimpact/btGImpactCollisionAlgorithm.h>
#include <BulletCollision/Gimpact/btGImpactShape.h>
#include <btBulletDynamicsCommon.h>

#include <Eigen/Eigenvalues>
#include <vector>

#include "core/connectivity.h"
#include "core/triangle_geometry.h"

namespace kappaflow {
namespace {

// How far off its surface a shape is taken to end [spacings].
constexpr double kMargin = 0.02;
// Sweeps over all contacts, and the share of an overlap that a step takes away.
constexpr int kIterations = 50;
constexpr double kOverlapTaken = 0.2;
// Height of a corner over its neighbour's plane that is rounding, over the length of an edge.
constexpr double kFlat = 1e-6;

btVector3 in_bullet(const Vec3& v) {
  return {v.x(), v.y(), v.z()};
}
Vec3 from_bullet(const btVector3& v) {
  return {v.x(), v.y(), v.z()};
}
btQuaternion in_bullet(const Eigen::Quaterniond& q) {
  return {q.x(), q.y(), q.z(), q.w()};
}
Eigen::Quaterniond from_bullet(const btQuaternion& q) {
  return {q.w(), q.x(), q.y(), q.z()};
}

/// Axis times angle, at most pi.
Vec3 turn_of(const Eigen::Quaterniond& q) {
  const Eigen::AngleAxisd turn(q);
  return turn.angle() * turn.axis();
}

/// Whether no edge of the surface, which encloses one solid, is bent inward.
bool is_convex(const TriangleSurface& surface) {
  const std::vector<int> twin = twins_of(surface.triangles);
  const auto corner = [&](int h) { return surface.vertices[origin_of(surface.triangles, h)]; };
  for (int h = 0; h < static_cast<int>(twin.size()); ++h) {
    if (twin[h] < 0) return false;
    const Vec3 start = corner(h);
    const Vec3 normal =
        twice_area_vector(start, corner(next_half_edge(h)), corner(previous_half_edge(h))).normalized();
    const Vec3 across = corner(previous_half_edge(twin[h])) - start;
    if (normal.dot(across) > kFlat * across.norm()) return false;
  }
  return true;
}

/// A collision shape with what it refers to.
struct Shape {
  std::vector<double> vertices;  // in spacings
  std::vector<int> corners;
  std::unique_ptr<btTriangleIndexVertexArray> mesh;
  std::unique_ptr<btCollisionShape> shape;
};

/// moves: it is a body's, not a wall's.
Shape shape_of(const SolidWall& solid, const RigidPose& frame, double spacing, bool moves) {
  Shape result;
  const TriangleSurface& surface = solid.surface();
  for (const Vec3& x : surface.vertices) {
    const Vec3 scaled = frame.inverse(x) / spacing;
    result.vertices.insert(result.vertices.end(), scaled.data(), scaled.data() + 3);
  }
  constexpr int kStride = 3 * sizeof(double);
  const int vertices = static_cast<int>(surface.vertices.size());
  if (solid.solids().size() == 1 && is_convex(surface)) {
    result.shape = std::make_unique<btConvexHullShape>(result.vertices.data(), vertices, kStride);
    result.shape->setMargin(kMargin);
    return result;
  }
  for (const Triangle& t : surface.triangles)
    for (const auto corner : t) result.corners.push_back(static_cast<int>(corner));
  result.mesh = std::make_unique<btTriangleIndexVertexArray>(
      static_cast<int>(surface.triangles.size()), result.corners.data(), 3 * static_cast<int>(sizeof(int)),
      vertices, result.vertices.data(), kStride);
  if (moves) {
    auto shape = std::make_unique<btGImpactMeshShape>(result.mesh.get());
    shape->setMargin(kMargin);
    shape->updateBound();
    result.shape = std::move(shape);
  } else {
    result.shape = std::make_unique<btBvhTriangleMeshShape>(result.mesh.get(), true);
    result.shape->setMargin(kMargin);
  }
  return result;
}

}  // namespace

/// Bullet works in spacings and in the mass of a particle, and with principal axes.
struct BodyCollisions::World {
  struct Body {
    Shape shape;
    Eigen::Quaterniond axes;  // principal ones, from those of the world at t = 0
    btVector3 inertia;
    double mass, friction;
  };
  struct Wall {
    Shape shape;
    BodyMotion motion;
  };

  std::unique_ptr<btRigidBody> wall_at(Wall& wall, double time, double dt) const;
  std::unique_ptr<btRigidBody> body_at(std::size_t b, const RigidBodies& bodies) const;

  double spacing = 0;
  std::vector<Body> bodies;
  std::vector<Wall> walls;
  btDefaultCollisionConfiguration configuration{[] {
    btDefaultCollisionConstructionInfo info;
    info.m_defaultMaxPersistentManifoldPoolSize = 256;  // more are allocated one by one
    info.m_defaultMaxCollisionAlgorithmPoolSize = 256;
    return info;
  }()};
};

BodyCollisions::BodyCollisions(const RigidBodies& bodies, std::span<const SolidWall> walls, double spacing)
    : world_(std::make_unique<World>()) {
  World& w = *world_;
  w.spacing = spacing;
  w.configuration.setConvexConvexMultipointIterations();
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const MassProperties& weight = bodies.weight(b);
    const Eigen::SelfAdjointEigenSolver<Mat3> principal(weight.inertia);
    Mat3 axes = principal.eigenvectors();
    if (axes.determinant() < 0) axes.col(0) = -axes.col(0);
    const double mass = bodies.mass(b)(0, 0);
    w.bodies.push_back({shape_of(bodies.described(b).solid, {axes, weight.centre}, spacing, true),
                        Eigen::Quaterniond(axes),
                        in_bullet(mass / (spacing * spacing) * principal.eigenvalues()), mass,
                        bodies.described(b).friction});
  }
  for (const SolidWall& wall : walls) w.walls.push_back({shape_of(wall, {}, spacing, false), wall.motion()});
}

BodyCollisions::~BodyCollisions() = default;
BodyCollisions::BodyCollisions(BodyCollisions&&) noexcept = default;
BodyCollisions& BodyCollisions::operator=(BodyCollisions&&) noexcept = default;

std::unique_ptr<btRigidBody> BodyCollisions::World::wall_at(Wall& wall, double time, double dt) const {
  btRigidBody::btRigidBodyConstructionInfo info(0, nullptr, wall.shape.shape.get());
  info.m_friction = 1;
  const RigidPose now = wall.motion.pose(time), next = wall.motion.pose(time + dt);
  const auto transform = [&](const Mat3& rotation, const Vec3& translation) {
    return btTransform(in_bullet(Eigen::Quaterniond(rotation)), in_bullet(translation / spacing));
  };
  info.m_startWorldTransform = transform(now.rotation, now.translation);
  auto result = std::make_unique<btRigidBody>(info);
  if (!wall.motion.at_rest()) {
    // Bullet takes the velocity from where it was a step ago: as far back as it will go on in this one.
    const Mat3 back = (next.rotation * now.rotation.transpose()).transpose();
    result->setCollisionFlags(result->getCollisionFlags() | btCollisionObject::CF_KINEMATIC_OBJECT);
    result->setInterpolationWorldTransform(
        transform(back * now.rotation, 2 * now.translation - next.translation));
    result->setActivationState(DISABLE_DEACTIVATION);
  }
  return result;
}

std::unique_ptr<btRigidBody> BodyCollisions::World::body_at(std::size_t b, const RigidBodies& all) const {
  const Body& body = bodies[b];
  const BodyState state = all.state(b);
  btRigidBody::btRigidBodyConstructionInfo info(body.mass, nullptr, body.shape.shape.get(), body.inertia);
  info.m_friction = body.friction;
  info.m_startWorldTransform =
      btTransform(in_bullet(all.attitude(b) * body.axes), in_bullet(state.velocity.point / spacing));
  auto result = std::make_unique<btRigidBody>(info);
  result->setFlags(0);  // no force of its own where it spins
  result->setActivationState(DISABLE_DEACTIVATION);
  result->setLinearVelocity(in_bullet(state.velocity.linear / spacing));
  result->setAngularVelocity(in_bullet(state.velocity.angular));
  return result;
}

void BodyCollisions::move(RigidBodies& bodies, double time, double dt) {
  World& w = *world_;
  bodies.forget_contact(dt);
  std::vector<std::unique_ptr<btRigidBody>> objects;  // the bodies first; they outlive the world
  btCollisionDispatcher dispatcher(&w.configuration);
  btGImpactCollisionAlgorithm::registerAlgorithm(&dispatcher);
  btDbvtBroadphase broadphase;
  btSequentialImpulseConstraintSolver solver;
  btDiscreteDynamicsWorld world(&dispatcher, &broadphase, &solver, &w.configuration);
  world.setGravity({0, 0, 0});
  btContactSolverInfo& info = world.getSolverInfo();
  info.m_numIterations = kIterations;
  info.m_splitImpulse = true;  // overlaps are taken away without velocities
  info.m_splitImpulsePenetrationThreshold = 0;
  info.m_erp2 = kOverlapTaken;

  for (std::size_t b = 0; b < bodies.size(); ++b) objects.push_back(w.body_at(b, bodies));
  for (World::Wall& wall : w.walls) objects.push_back(w.wall_at(wall, time, dt));
  for (std::size_t k = 0; k < objects.size(); ++k) {
    objects[k]->setUserIndex(static_cast<int>(k));
    world.addRigidBody(objects[k].get());
  }
  world.stepSimulation(dt, 0);

  std::vector<char> touches(objects.size(), 0);
  for (int m = 0; m < dispatcher.getNumManifolds(); ++m) {
    const btPersistentManifold* manifold = dispatcher.getManifoldByIndexInternal(m);
    if (manifold->getNumContacts() == 0) continue;
    for (const auto* object : {manifold->getBody0(), manifold->getBody1()})
      touches[static_cast<std::size_t>(object->getUserIndex())] = 1;
  }
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    if (touches[b]) {
      const Vec3 velocity = w.spacing * from_bullet(objects[b]->getLinearVelocity());
      const Vec3 angular = from_bullet(objects[b]->getAngularVelocity());
      const btTransform& end = objects[b]->getWorldTransform();
      const Vec3 path = w.spacing * from_bullet(end.getOrigin()) - bodies.state(b).velocity.point;
      const Eigen::Quaterniond attitude = from_bullet(end.getRotation()) * w.bodies[b].axes.conjugate();
      const Vec3 turn = turn_of(attitude * bodies.attitude(b).conjugate());
      rigid::Vector6 motion;
      motion.head<3>() = velocity;
      motion.tail<3>() = angular;
      bodies.note_contact(b, motion, dt);
      bodies.move(b, dt, path - dt * velocity, turn - dt * angular);
    } else {
      bodies.move(b, dt);
    }
  }
  for (const auto& object : objects) world.removeRigidBody(object.get());
}

}  // namespace kappaflow
