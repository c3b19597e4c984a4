#include "core/errors.h"

#include <fmt/format.h>

namespace kappaflow {
namespace {

std::string located(const SourcePosition& where, const std::string& message) {
  if (where.line <= 0) return fmt::format("{}: {}", where.file, message);
  if (where.column <= 0) return fmt::format("{}:{}: {}", where.file, where.line, message);
  return fmt::format("{}:{}:{}: {}", where.file, where.line, where.column, message);
}

}  // namespace

InvalidInput::InvalidInput(const SourcePosition& where, const std::string& message)
    : Error(located(where, message), 2) {}

SolverFailure::SolverFailure(double time, std::size_t step, const FailedParticle& particle,
                             const std::string& message)
    : Error(fmt::format("the simulation failed at t = {:.6g} s, step {}, particle {} at ({:.6g}, {:.6g}, "
                        "{:.6g}) m with {:.4g} m/s: {}",
                        time, step, particle.id, particle.position.x(), particle.position.y(),
                        particle.position.z(), particle.speed, message),
            3) {}

TopologyError::TopologyError(const Vec3& position, const std::string& message)
    : Error(fmt::format("mesh at ({:.6g}, {:.6g}, {:.6g}): {}", position.x(), position.y(), position.z(),
                        message),
            4) {}

IoError::IoError(const std::string& path, const std::string& message)
    : Error(fmt::format("{}: {}", path, message), 5) {}

void throw_told(const std::string& what, int exit_code) {
  if (exit_code == InvalidInput("").exit_code()) throw InvalidInput(what);
  if (exit_code == SolverFailure("").exit_code()) throw SolverFailure(what);
  if (exit_code == IoError("").exit_code()) throw IoError(what);
  throw Error(what, exit_code);
}

}  // namespace kappaflow
