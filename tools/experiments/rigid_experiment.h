// Bodies of particles in an exact rigid motion, tracked with every combination of methods and options that a
// file names: the engine of the experiments of Figs. 3 to 8.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "surface/field/rigid_particles.h"
#include "surface/mesh/mesh_measures.h"
#include "surface/tracker/surface_tracker.h"
#include "tools/experiments/experiment.h"

namespace kappaflow {

struct TrackedBody {
  std::string name;
  FieldParticles particles;  ///< at t = 0
  double threshold = 0;      ///< T of Eq. 12
  double edge_length = 0;    ///< of the mesh [m]
};

/// An experiment as its file describes it. Times are in cycles: turns of a rotation, or the whole of a
/// translation; a cycle takes a second.
struct RigidExperiment {
  std::string title;
  SteadyMotion motion;
  int cycles = 1, steps_per_cycle = 1;
  std::vector<TrackedBody> bodies;
  std::vector<std::string> methods;
  std::vector<TimeIntegrator> integrators;
  std::vector<int> fairing_iterations;
  std::vector<int> picture_cycles;  ///< meshes are kept after these
  double checker_size = 0;          ///< edge of a checker cube [m]
  TrackerOptions tracker;           ///< all but method, integrator and fairing iterations
};

/// quick: with the values of the file's table [quick]. Throws InvalidInput "file:line:column: ...".
RigidExperiment read_rigid_experiment(const std::filesystem::path& file, bool quick);

/// A tracked mesh after one step. Errors are distances of vertices from where the rigid motion takes them, in
/// units of the body's size: its largest distance from the axis (from the centre in a translation).
struct RigidSample {
  double cycle = 0;
  double mean_error = 0, max_error = 0;
  QualityRange quality;
  TriangleDistortion distortion;
  std::size_t unprojected = 0;
};

/// One combination, tracked to the end.
struct RigidCase {
  const TrackedBody* body = nullptr;
  std::string method;
  TimeIntegrator integrator = TimeIntegrator::rk4;
  int fairing_iterations = 0;
  double size = 0;                   ///< of the body [m]
  std::vector<RigidSample> samples;  ///< one a step; samples[0] is the start
  std::vector<TriangleMesh> kept;    ///< one for each of picture_cycles

  double mean_over_run() const;  ///< mean over the steps of mean_error
  double max_over_run() const;   ///< largest max_error
  /// mean_error after whole cycles: the paper's error, since whole turns lead back to the start.
  double end_error(int cycle, int steps_per_cycle) const {
    return samples[cycle * steps_per_cycle].mean_error;
  }
};

/// The body's mesh at the start. Throws InvalidInput with the file's name where it has no surface.
TriangleMesh start_mesh(const RigidExperiment& experiment, const TrackedBody& body, const std::string& file);

/// Tracks one combination with that velocity, which c.method names, and fills in size, samples and kept.
void run_rigid_case(const RigidExperiment& experiment, const TriangleMesh& start,
                    const VelocityFunction& velocity, RigidCase& c);

/// Tracks every combination, in the order body, integrator, fairing, method.
std::vector<RigidCase> run_rigid_experiment(const RigidExperiment& experiment,
                                            const ExperimentContext& context);

/// errors.csv (a row a step) and summary.csv (a row a case) into context.folder; and the kept meshes as
/// BODY-METHOD-INTEGRATOR-FAIRING_CYCLE.vtp. Returns the files' names for the report.
std::vector<std::string> write_rigid_results(const RigidExperiment& experiment,
                                             const std::vector<RigidCase>& cases,
                                             const ExperimentContext& context);

/// The chosen cases' kept meshes, a row of panels a cycle; `name`.png in context.folder.
void draw_rigid_meshes(const RigidExperiment& experiment, const std::vector<const RigidCase*>& cases,
                       const std::string& name, const ExperimentContext& context);

/// The cases that `keep` says yes to.
std::vector<const RigidCase*> select(const std::vector<RigidCase>& cases,
                                     const std::function<bool(const RigidCase&)>& keep);
/// The only such case. Throws InvalidInput where the experiment has none.
const RigidCase& find_case(const std::vector<RigidCase>& cases, std::string_view body,
                           std::string_view method, TimeIntegrator integrator, int fairing_iterations);

/// What all of these experiments have in common, for the chapter's introduction.
std::string rigid_setting(const RigidExperiment& experiment);

}  // namespace kappaflow
