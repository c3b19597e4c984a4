// Runs of a scene on ranks that are threads.
#pragma once

#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <thread>
#include <vector>

#include "core/errors.h"
#include "tests/thread_ranks.h"
#include "tests/tools/scratch.h"
#include "tools/runs/run.h"

namespace kappaflow {

namespace fs = std::filesystem;

/// A ball with its middle 14 spacings deep, that falls, and a hot drop. Nothing flat of a lattice, where
/// edges are of one length and rounding says which is edited.
inline constexpr const char* kScene = R"(
duration = 0.04
[fluid]
spacing = 0.05
kinematic_viscosity = 0.02
density = 1000
gravity = [0, -9.81, 0]
[[fluid.block]]
shape = "sphere"
center = [0.51, 0.9, 0.52]
radius = 0.72
velocity = [0.5, -2, 0]
[[fluid.block]]
shape = "sphere"
center = [1.9, 0.7, 0.6]
radius = 0.2
temperature = 350
[[wall]]
shape = "box"
lower = [-5, -1, -5]
upper = [5, 0, 5]
[heat]
temperature = 300
specific_heat = 1000
conductivity = 10
[surface]
methods = ["regional"]
threshold = 2.5
[output]
frames_per_second = 100
checkpoint_interval = 3
metrics_interval = 2
)";
inline constexpr int kLast = 4;  // frame

class RunsOnRanks : public Scratch {
 protected:
  /// many, surface_ranks: see RunOptions.
  RunOptions options(const char* name, std::size_t many, int surface_ranks = 1) const {
    RunOptions o;
    o.scene = folder / "balls.toml";
    if (!fs::exists(o.scene)) std::ofstream(o.scene) << kScene;
    o.folder = folder / name;
    o.threads = 2;
    o.many = many;
    o.surface_ranks = surface_ranks;
    o.force = o.quiet = true;
    return o;
  }
};

inline constexpr std::size_t kAll = 1'000'000, kFew = 100;

/// Does something when it has told the surfaces' rank so many things.
class WatchedRanks final : public ThreadRanks {
 public:
  WatchedRanks(RankBoard& board, int rank, int told, const std::function<void()>& work)
      : ThreadRanks(board, rank), left_(told), work_(work) {}
  void exchange_asleep(std::span<const Parcel> sent, std::span<const Parcel> received) override {
    if (!sent.empty() && --left_ == 0) work_();
    ThreadRanks::exchange_asleep(sent, received);
  }

 private:
  int left_;
  const std::function<void()>& work_;
};

struct Outcome {
  int signal = 0;
  std::string error{};
};

/// On so many ranks; of one, alone. Does `work` meanwhile, once so many things are told.
inline Outcome run_on(int size, RunOptions options, int told = 0,
                      const std::function<void()>& work = {}) noexcept {
  if (size == 1) return {run_scene(options).interrupted_by};
  RankBoard board(size);
  std::vector<std::jthread> others;
  for (int rank = 1; rank < size; ++rank)
    others.emplace_back([&board, rank, options, told, &work]() mutable {
      WatchedRanks ranks(board, rank, told, work);
      options.ranks = &ranks;
      follow_run(options);
    });
  ThreadRanks ranks(board, 0);
  options.ranks = &ranks;
  Outcome outcome;
  try {
    outcome.signal = run_scene(options).interrupted_by;
  } catch (const Error& error) {
    outcome.error = fmt::format("{}: {}", error.exit_code(), error.what());
  }
  ranks.announce({RankTask::end});
  return outcome;
}

}  // namespace kappaflow
