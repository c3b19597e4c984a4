// What runs promise: the same bits whatever the threads and however often they are stopped, and a clear end
// where a disk is full or a simulation fails.
#include "tests/tools/commands/reliability.h"

#include <fmt/format.h>

#include <csignal>
#include <cstdlib>
#include <map>

#include "surface/tracker/surface_methods.h"
#include "tests/tools/everything_scene.h"
#include "tests/tools/full_disk.h"
#include "tests/tools/text_table.h"
#include "tests/vtk_reader.h"

namespace kappaflow {
namespace {

namespace fs = std::filesystem;

const std::string kSmallScene = KAPPAFLOW_SOURCE_DIR "/scenes/staircase-small.toml";

std::vector<std::string> words_to_run(const std::string& scene, const fs::path& out) {
  return {"run", scene, "--out", out.string(), "--track", "total,regional", "--format", "ply,usd"};
}

TEST_F(Reliability, SameBitsWhateverTheThreadsWithEveryMethod) {
  std::string methods;
  for (const std::string_view name : surface_method_names()) methods += fmt::format("{},", name);
  methods.pop_back();
  for (const char* name : {"1", "2", "4", "4 again"}) {
    const ProgramResult result =
        run_program({"run", kSmallScene, "--out", (folder / name).string(), "--duration", "0.12", "--track",
                     methods, "--threads", std::string(name, 1)});
    ASSERT_EQ(result.exit_code, 0) << result.err;
  }
  EXPECT_EQ(results_in(folder / "1").size(), 3 + 2 + 2 + 10 + 4 * (1 + 10));
  for (const char* name : {"2", "4", "4 again"}) expect_same_results(folder / "1", folder / name);
}

// KAPPAFLOW_KILLS: how many; see the ctest of the configuration `long`.
TEST_F(Reliability, KilledRunsGoOnToTheSameBits) {
  const char* wanted = std::getenv("KAPPAFLOW_KILLS");
  const int kills = wanted ? std::atoi(wanted) : 6;
  const std::string scene = file("scene.toml", bytes_of(kSmallScene) + "checkpoint_interval = 2\n").string();
  const double whole = run_whole(words_to_run(scene, folder / "whole"));
  std::mt19937 random(1);
  const fs::path out = folder / "killed";
  for (int done = 0; done < kills;) {
    fs::remove_all(out);
    done += run_with_stops(words_to_run(scene, out), out, SIGKILL, whole, random);
    expect_same_results(folder / "whole", out);
    if (HasFailure()) return;
  }
}

TEST_F(Reliability, SignalsBetweenFramesLeaveTheWholeStateToGoOnFrom) {
  const std::string scene = file("everything.toml", kEverythingScene).string();
  const auto words = [&](const char* out) {
    return std::vector<std::string>{"run", scene, "--out", (folder / out).string()};
  };
  const double whole = run_whole(words("whole"));
  std::mt19937 random(2);
  int stops = 0;
  for (int tries = 0; tries < 10 && stops < 2; ++tries) {  // a run may end before its second signal
    fs::remove_all(folder / "stopped");
    stops = run_with_stops(words("stopped"), folder / "stopped", SIGTERM, whole, random);
  }
  EXPECT_GE(stops, 2);
  expect_same_results(folder / "whole", folder / "stopped");
  EXPECT_NE(bytes_of(folder / "stopped" / "run.json").find("\"resumed\""), std::string::npos);
  EXPECT_EQ(read_table(folder / "stopped" / "timings.csv").size(),
            read_table(folder / "whole" / "timings.csv").size());

  const ProgramResult again = run_program({"run", "--resume", (folder / "stopped").string()});
  EXPECT_EQ(again.exit_code, 0) << again.err;
  EXPECT_EQ(again.out, (folder / "stopped").string() + ": the run is complete, 6 frames\n");
}

// Ten times the frames to the same moment; a mesh that is left alone has the same size in both.
TEST_F(Reliability, ACheckpointDoesNotGrowWithTheFrames) {
  std::string scene = bytes_of(kSmallScene);
  scene.insert(scene.find("fairing_iterations"), "remesh = false\ntopology = false\n");
  const auto size_after = [&](const std::string& rate) {
    std::string text = scene;
    text.replace(text.find("= 25.0"), 6, "= " + rate);
    const fs::path out = folder / rate;
    const ProgramResult result =
        run_program({"run", file("scene.toml", text).string(), "--out", out.string(), "--duration", "0.08"});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return fs::file_size(out / "checkpoint.bin");
  };
  EXPECT_EQ(size_after("25.0"), size_after("250.0"));
  EXPECT_EQ(read_table(folder / "250.0" / "metrics.csv").size(), 2 * 21u);
}

// What the format's number promises. Of the run that tests/data/checkpoint was, the tables are enough.
TEST_F(Reliability, ACheckpointOfAnEarlierProgramGoesOn) {
  fs::copy(KAPPAFLOW_SOURCE_DIR "/tests/data/checkpoint", folder / "run");
  for (const char* data : {"particles", "boundary", "surface-normal"})
    fs::create_directory(folder / "run" / data);
  const ProgramResult result = run_program({"run", "--resume", (folder / "run").string()});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  const auto rows = read_table(folder / "run/metrics.csv");
  ASSERT_EQ(rows.size(), 3u);
  EXPECT_EQ(rows.back().at("time"), "0.04");
  EXPECT_NE(result.out.find(", 3 frames, "), std::string::npos) << "the earlier ones count: " << result.out;
}

TEST_F(Reliability, AChangedSceneIsNotResumed) {
  const std::string scene = file("scene.toml", bytes_of(kSmallScene)).string();
  const fs::path out = folder / "run";
  ASSERT_EQ(run_program(words_to_run(scene, out), {}, {SIGINT, out / "checkpoint.bin"}).exit_code, 130);
  file("scene.toml", bytes_of(kSmallScene) + "\n# changed");
  const ProgramResult other = run_program({"run", scene, "--resume", out.string()});
  EXPECT_EQ(other.exit_code, 2);
  EXPECT_EQ(other.err, "kappaflow: error: " + scene + ": is not the scene that the run in " + out.string() +
                           " began with\n");
  file("run/run.toml", bytes_of(kSmallScene) + "\n# changed");
  const ProgramResult changed = run_program({"run", "--resume", out.string()});
  EXPECT_EQ(changed.exit_code, 2);
  EXPECT_EQ(changed.err, "kappaflow: error: " + (out / "run.toml").string() +
                             ": the scene, or a mesh that it names, has changed since the run began\n");
}

TEST_F(Reliability, FullDiskStopsTheRunAndLeavesItsCheckpoint) {
  const fs::path out = folder / "run";
  ASSERT_EQ(run_program(words_to_run(kSmallScene, folder / "whole")).exit_code, 0);
  ASSERT_EQ(run_program(words_to_run(kSmallScene, out), {}, {SIGINT, out / "surface-total/surface_0002.vtp"})
                .exit_code,
            130);
  for (const rlim_t bytes : {4096, 60000, 200000}) {  // tables; particles; surfaces; the checkpoint
    const FullDisk full(bytes);
    const ProgramResult result = run_program({"run", "--resume", out.string()});
    EXPECT_EQ(result.exit_code, 5);
    EXPECT_EQ(result.err.find("kappaflow: error: " + out.string()), 0u) << result.err;
    EXPECT_NE(result.err.find(" bytes cannot be "), std::string::npos) << result.err;
    EXPECT_NE(result.err.find("File too large"), std::string::npos) << result.err;
    EXPECT_EQ(std::ranges::count(result.err, '\n'), 1) << result.err;
  }
  EXPECT_EQ(run_program({"run", "--resume", out.string()}).exit_code, 0);
  expect_same_results(folder / "whole", out);
}

// Each fails later than the one before: with the folder's tables, with its first mesh, with its first frame.
TEST_F(Reliability, ARunThatCannotBeginLeavesTheOneThatItWasToReplace) {
  const fs::path out = folder / "run";
  const std::vector<std::string> replace{"run", kSmallScene, "--out", out.string(), "--force"};
  ASSERT_EQ(run_program({"run", kSmallScene, "--out", out.string(), "--duration", "0.02"}).exit_code, 0);
  fs::copy(out, folder / "before", fs::copy_options::recursive);
  const auto run_on_full_disk = [&](rlim_t bytes) {
    const FullDisk full(bytes);
    return run_program(replace);
  };
  const auto expect_untouched = [&](const ProgramResult& result, int exit_code) {
    EXPECT_EQ(result.exit_code, exit_code) << result.err;
    expect_same_results(folder / "before", out);
    EXPECT_EQ(bytes_of(folder / "before/run.json"), bytes_of(out / "run.json"));
  };
  expect_untouched(run_on_full_disk(400), 5);
  std::string bare = bytes_of(kSmallScene);
  bare.insert(bare.find("fairing_iterations"), "threshold = 100.0\n");
  bare = file("bare.toml", bare).string();
  expect_untouched(run_program({"run", bare, "--out", out.string(), "--force"}), 2);
  expect_untouched(run_on_full_disk(4096), 5);
  EXPECT_EQ(run_program(replace).exit_code, 0);
  ASSERT_EQ(run_program({"run", kSmallScene, "--out", (folder / "new").string()}).exit_code, 0);
  expect_same_results(folder / "new", out);
}

class Failing : public Reliability {
 protected:
  /// said: part of the message for the small scene with these texts in place of others.
  void expect_failure(const std::map<std::string, std::string>& replaced, const std::string& said) {
    std::string scene = bytes_of(kSmallScene);
    for (const auto& [text, by] : replaced) {
      ASSERT_NE(scene.find(text), std::string::npos) << text;
      scene.replace(scene.find(text), text.size(), by);
    }
    const fs::path out = folder / "run";
    const ProgramResult result =
        run_program({"run", file("scene.toml", scene).string(), "--out", out.string()});
    ASSERT_EQ(result.exit_code, 3) << result.err;
    EXPECT_EQ(std::ranges::count(result.err, '\n'), 1) << result.err;
    for (const std::string& part :
         {std::string("failed at t = "), std::string(" s, step "), std::string(", particle "),
          std::string(" m/s: "), said, "its particles are in " + (out / "failure.vtp").string()})
      EXPECT_NE(result.err.find(part), std::string::npos) << part << "\n" << result.err;
    EXPECT_EQ(read_vtp(out / "failure.vtp")->GetNumberOfPoints(), 1000);
  }
};

TEST_F(Failing, SpeedThatNeedsTooShortSteps) {
  expect_failure(
      {{"[1.2, 0.0, 0.0]", "[9e3, 0.0, 0.0]"}, {"[surface]", "[solver]\nmin_time_step = 1e-5\n[surface]"}},
      "min_time_step");
}

// So viscous a liquid would once have needed steps of 1e-6 s.
TEST_F(Reliability, LiquidStifferThanRockRunsThrough) {
  std::string scene = bytes_of(kSmallScene);
  const std::string viscosity = "kinematic_viscosity = 1.0";
  scene.replace(scene.find(viscosity), viscosity.size(), "kinematic_viscosity = 1e9");
  const ProgramResult result =
      run_program({"run", file("scene.toml", scene).string(), "--out", (folder / "run").string()});
  EXPECT_EQ(result.exit_code, 0) << result.err;
}

TEST_F(Failing, ViscositySolverThatDoesNotConverge) {
  expect_failure({{"[surface]", "[solver]\nmax_viscosity_iterations = 1\n[surface]"}},
                 "raise max_viscosity_iterations");
}

TEST_F(Failing, PressureSolverThatDoesNotConverge) {
  expect_failure(
      {{"kinematic_viscosity = 1.0", "kinematic_viscosity = 0.01"},
       {"[surface]", "[solver]\nmax_pressure_iterations = 1\nmax_time_step = 0.1\ncfl = 1.0\n[surface]"}},
      "raise max_pressure_iterations");
}

}  // namespace
}  // namespace kappaflow
