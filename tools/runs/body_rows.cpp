#include "tools/runs/body_rows.h"

#include <fmt/format.h>

#include <Eigen/Geometry>

namespace kappaflow {
namespace {

Eigen::Quaterniond quaternion(const Mat3& rotation) {
  Eigen::Quaterniond q(rotation);
  q.normalize();
  if (q.w() < 0) q.coeffs() *= -1;
  return q;
}

}  // namespace

std::string bodies_header() {
  return "frame,time,body,x,y,z,qx,qy,qz,qw,vx,vy,vz,wx,wy,wz\n";
}

std::string bodies_rows(int frame, double time, std::span<const BodyState> bodies) {
  std::string rows;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const RigidVelocity& velocity = bodies[b].velocity;
    const Eigen::Quaterniond q = quaternion(bodies[b].pose.rotation);
    rows += fmt::format("{},{:.12g},{}", frame, time, b);
    for (const Vec3& v : {velocity.point, Vec3(q.vec())})
      rows += fmt::format(",{:.12g},{:.12g},{:.12g}", v.x(), v.y(), v.z());
    rows += fmt::format(",{:.12g}", q.w());
    for (const Vec3& v : {velocity.linear, velocity.angular})
      rows += fmt::format(",{:.12g},{:.12g},{:.12g}", v.x(), v.y(), v.z());
    rows += "\n";
  }
  return rows;
}

}  // namespace kappaflow
