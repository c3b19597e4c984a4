// What the paper leaves open about its turning particles (Figs. 4, 5 and 8), swept: every combination of the
// values that a file names, tracked with total velocity and with Eq. 10.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "tools/experiments/rigid_experiment.h"
#include "tools/experiments/searched_velocity.h"

namespace kappaflow {

/// One choice of everything. The rows of Eq. 10 are not scaled (RowScale::metre), so that sigma is the unit
/// of length; at 1 m they are the scaled ones.
struct PaperSetting {
  double sigma = 1;           ///< [m]
  double radius = 0.3;        ///< of the circle on which the centres are [sigma]
  double threshold = 0.3;     ///< T of Eq. 12
  double edge_length = 0.14;  ///< of the mesh [sigma]
  int steps_per_turn = 40;
  TimeIntegrator integrator = TimeIntegrator::rk4;
  int fairing_iterations = 0;
  FairedVertices fairing_moves = FairedVertices::all;
  double fairing_relaxation = 0.5;
  /// Of Eq. 10, in units of its row of H at this sigma, 1/sigma^2. Where fairing moves the undetermined
  /// vertices it decides which are: those whose rows are smaller.
  double damping = 1e-6;
  TangentialSearch search;  ///< of Eq. 10's minimum
};

/// Something that the paper leaves open and the values that it takes in a map.
struct PaperChoice {
  std::string key;                  ///< as the file calls it
  std::string label;                ///< with its unit, for axes
  std::vector<std::string> values;  ///< as texts
  std::function<void(std::size_t value, PaperSetting&)> set;
};

/// Errors after each turn and over the run, in body sizes.
struct PaperErrors {
  std::vector<double> after_turn;  ///< mean distance to the start; [0] after the first turn
  double over_run = 0;             ///< mean distance to the true trajectory
  std::size_t unprojected = 0;     ///< vertices off the surface at the end
  double end() const { return after_turn.back(); }
};

struct PaperResult {
  std::vector<std::size_t> place;  ///< of each choice's value
  PaperSetting setting;
  PaperErrors total, curvature;
};

/// Every combination of the values of its choices.
struct PaperMap {
  std::string name, title;
  std::size_t x = 0, y = 0;  ///< choices along the axes; each combination of the others is a panel
  std::vector<PaperChoice> choices;
  std::vector<PaperResult> results;  ///< the last choice runs fastest
};

/// The maps of one number of particles.
struct PaperSweep {
  std::string name;  ///< of its table in the file
  int particles = 3;
  int turns = 3;
  TrackerOptions tracker;
  std::vector<PaperChoice> choices;  ///< with the values that maps take where they do not say
  std::vector<PaperMap> maps;
};

/// The file's tables [three] and [one], in this order. Throws InvalidInput "file:line:column: ...".
std::vector<PaperSweep> read_paper_sweeps(const std::filesystem::path& file, bool quick);

/// "three particles: radius 0.3, ...": what maps take where they do not say, for the introduction.
std::string sweeps_text(const std::vector<PaperSweep>& sweeps);

/// Tracks all settings and fills in the results. Settings run side by side; of total velocity those that
/// differ only in what it does not know, the unit of length and the search, are run once.
void run_paper_sweep(PaperSweep& sweep, const ExperimentContext& context);

}  // namespace kappaflow
