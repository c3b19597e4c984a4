// The errors that leave the libraries. The command line prints what() on one line and exits with exit_code().
#pragma once

#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>

#include "core/types.h"

namespace kappaflow {

/// Base of every error that is reported to a user. what() is one line.
class Error : public std::runtime_error {
 public:
  Error(const std::string& message, int exit_code) : std::runtime_error(message), exit_code_(exit_code) {}
  int exit_code() const { return exit_code_; }

 private:
  int exit_code_;
};

/// Where in a text file something stands; line and column count from 1, 0 means unknown (and is not printed).
struct SourcePosition {
  std::string file;
  int line = 0;
  int column = 0;
};

/// The user's input is wrong: "file:line:column: what was found; what is allowed". Exit code 2.
class InvalidInput : public Error {
 public:
  explicit InvalidInput(const std::string& message) : Error(message, 2) {}
  InvalidInput(const SourcePosition& where, const std::string& message);
};

/// The particle that a failure shows in.
struct FailedParticle {
  std::int64_t id = 0;
  Vec3 position = Vec3::Zero();  ///< [m]
  double speed = 0;              ///< [m/s]
};

/// The simulation cannot go on (not finite, exploding, not converging). Exit code 3.
class SolverFailure : public Error {
 public:
  /// time: at the step's start [s]; step: counted from 1.
  SolverFailure(double time, std::size_t step, const FailedParticle& particle, const std::string& message);
  /// As what() of another one has it.
  explicit SolverFailure(const std::string& text) : Error(text, 3) {}
};

/// The mesh is not what an operation needs (not closed, not manifold). position [m]. Exit code 4.
class TopologyError : public Error {
 public:
  TopologyError(const Vec3& position, const std::string& message);
};

/// A file cannot be read or written. Exit code 5.
class IoError : public Error {
 public:
  IoError(const std::string& path, const std::string& message);
  /// As what() of another one has it.
  explicit IoError(const std::string& text) : Error(text, 5) {}
};

/// Throws an error that another process has had: as what() and exit_code() of that say.
[[noreturn]] void throw_told(const std::string& what, int exit_code);

}  // namespace kappaflow
