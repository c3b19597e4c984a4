// Surfaces on a rank of their own, and the liquid on others, against both in one place; ranks are threads.
#include "tools/runs/distant_liquid.h"

#include <sstream>

#include "core/errors.h"
#include "tests/thread_ranks.h"
#include "tests/tools/everything_scene.h"
#include "tests/tools/scratch.h"
#include "tools/runs/simulation.h"

namespace kappaflow {
namespace {

const std::vector<double> kTimes{0.025, 0.05, 0.075, 0.1, 0.12};

PreparedScene everything() {
  PreparedScene scene = prepare(parse_scene(kEverythingScene, "everything.toml"));
  scene.scene.output.frames_per_second = 40;
  return scene;
}

/// Calls `work` with the first of so many ranks, whose others share the liquid, by themselves or with it.
/// Ends the program where it throws: the others would wait for it.
void with_ranks(int size, bool apart, const std::function<void(PreparedScene&, Ranks&)>& work) noexcept {
  RankBoard board(size);
  std::vector<std::jthread> others;
  for (int rank = 1; rank < size; ++rank)
    others.emplace_back([&board, rank, apart] {
      ThreadRanks ranks(board, rank);
      const RankOrder order = ranks.next_order();
      if (order.task == RankTask::end) return;
      PreparedScene prepared = everything();
      if (!apart) {
        make_fluid(prepared, &ranks).follow();
        return;
      }
      serve_liquid(std::move(prepared), set_apart(ranks));
      ranks.next_order();
    });
  ThreadRanks ranks(board, 0);
  PreparedScene prepared = everything();
  work(prepared, ranks);
  ranks.announce({RankTask::end});
}

/// What a run leaves in each frame.
struct Frames {
  std::vector<LiquidRecord> liquid;
  std::vector<TriangleMesh> mesh;
  std::vector<SimulationReport> report;
  std::vector<std::size_t> steps;

  void add(Simulation& simulation) {
    liquid.push_back(simulation.liquid().record());
    mesh.push_back(simulation.surfaces().mesh());
    report.push_back(simulation.take_report());
    steps.push_back(simulation.liquid().steps());
  }
};

void expect_same(const Frames& a, const Frames& b) {
  ASSERT_EQ(a.steps, b.steps);
  for (std::size_t k = 0; k < a.steps.size(); ++k) {
    const LiquidRecord &x = a.liquid[k], &y = b.liquid[k];
    EXPECT_EQ(x.particles.particles.id, y.particles.particles.id) << "frame " << k;
    EXPECT_EQ(x.particles.particles.position, y.particles.particles.position);
    EXPECT_EQ(x.particles.particles.velocity, y.particles.particles.velocity);
    EXPECT_EQ(x.particles.density, y.particles.density);
    EXPECT_EQ(x.particles.pressure, y.particles.pressure);
    EXPECT_EQ(x.particles.source, y.particles.source);
    EXPECT_EQ(x.particles.temperature, y.particles.temperature);
    EXPECT_EQ(x.count, y.count);
    EXPECT_EQ(x.compression.mean, y.compression.mean);
    EXPECT_EQ(x.compression.max, y.compression.max);
    EXPECT_EQ(x.temperature->mean, y.temperature->mean);
    EXPECT_EQ(x.taken, y.taken);
    ASSERT_EQ(x.bodies.size(), y.bodies.size());
    EXPECT_EQ(x.bodies[0].pose.translation, y.bodies[0].pose.translation);
    EXPECT_EQ(x.bodies[0].velocity.angular, y.bodies[0].velocity.angular);
    EXPECT_EQ(a.mesh[k].position, b.mesh[k].position);
    EXPECT_EQ(a.mesh[k].triangles, b.mesh[k].triangles);
    EXPECT_EQ(a.mesh[k].source, b.mesh[k].source);
    EXPECT_EQ(a.report[k].density_error_mean, b.report[k].density_error_mean);
    EXPECT_EQ(a.report[k].density_error_max, b.report[k].density_error_max);
    EXPECT_EQ(a.report[k].viscosity_error, b.report[k].viscosity_error);
  }
}

bool go_on(const FluidStep&) {
  return true;
}

Frames frames_of(Simulation& simulation) {
  Frames frames;
  for (const double time : kTimes) {
    EXPECT_TRUE(simulation.advance(time, go_on));
    frames.add(simulation);
  }
  return frames;
}

std::unique_ptr<Simulation> simulation_of(PreparedScene& prepared, Ranks& ranks, bool apart) {
  if (!apart) return std::make_unique<Simulation>(prepared, own_liquid(prepared, &ranks));
  return std::make_unique<Simulation>(prepared, std::make_unique<DistantLiquid>(prepared, set_apart(ranks)));
}

Frames frames_on(int size, bool apart) {
  Frames frames;
  with_ranks(size, apart, [&](PreparedScene& prepared, Ranks& ranks) {
    frames = frames_of(*simulation_of(prepared, ranks, apart));
  });
  return frames;
}

TEST(DistantLiquid, OfOneRankIsThatOfOneProcess) {
  Simulation alone(everything());
  expect_same(frames_of(alone), frames_on(2, true));
}

TEST(DistantLiquid, OfTwoRanksIsTheirs) {
  expect_same(frames_on(2, false), frames_on(3, true));
}

// Stopped after every step of the surfaces, and begun anew from what was saved.
TEST(DistantLiquid, SavedAndReadBackIsTheSame) {
  Simulation alone(everything());
  Frames frames;
  std::string state;
  int stops = 0;
  for (std::size_t k = 0; k < kTimes.size();)
    with_ranks(3, true, [&](PreparedScene& prepared, Ranks& ranks) {
      const std::unique_ptr<Simulation> simulation = simulation_of(prepared, ranks, true);
      if (!state.empty()) {
        std::istringstream text(state);
        StateReader archive(text);
        archive(*simulation);
      }
      if (simulation->advance(kTimes[k], [](const FluidStep&) { return false; })) {
        frames.add(*simulation);
        ++k;
      }
      ++stops;
      std::ostringstream text;
      StateWriter(text, little_endian())(*simulation);
      state = std::move(text).str();
    });
  EXPECT_GT(stops, 7);
  expect_same(frames_on(2, false), frames);
}

TEST(DistantLiquid, SavesWhatOneProcessSaves) {
  Simulation alone(everything());
  alone.advance(kTimes[0], go_on);
  std::ostringstream expected, found;
  StateWriter(expected, little_endian())(alone);
  with_ranks(2, true, [&](PreparedScene& prepared, Ranks& ranks) {
    const std::unique_ptr<Simulation> simulation = simulation_of(prepared, ranks, true);
    simulation->advance(kTimes[0], go_on);
    StateWriter(found, little_endian())(*simulation);
  });
  EXPECT_TRUE(expected.str() == found.str());
}

// What one process began, stopped where the surfaces lag behind.
TEST(DistantLiquid, GoesOnWithWhatOneProcessSaved) {
  Simulation alone(everything());
  int steps = 0;
  ASSERT_FALSE(alone.advance(kTimes[0], [&](const FluidStep&) { return ++steps < 3; }));
  std::stringstream state;
  StateWriter(state, little_endian())(alone);
  Frames frames;
  with_ranks(2, true, [&](PreparedScene& prepared, Ranks& ranks) {
    const std::unique_ptr<Simulation> simulation = simulation_of(prepared, ranks, true);
    StateReader archive(state);
    archive(*simulation);
    frames = frames_of(*simulation);
  });
  expect_same(frames_of(alone), frames);
}

TEST(DistantLiquid, AFailureIsToldWithTheParticles) {
  const auto fail = [](PreparedScene& prepared) {
    prepared.scene.fluid.cfl = 0.1;
    prepared.scene.fluid.min_time_step = prepared.scene.fluid.max_time_step;
  };
  std::string expected, found;
  PreparedScene own = everything();
  fail(own);
  try {
    Simulation(own).advance(kTimes[1], go_on);
  } catch (const SolverFailure& failure) {
    expected = failure.what();
  }
  RankBoard board(2);
  std::jthread other([&] {
    ThreadRanks ranks(board, 1);
    ranks.next_order();
    PreparedScene prepared = everything();
    fail(prepared);
    serve_liquid(std::move(prepared), set_apart(ranks));
  });
  ThreadRanks ranks(board, 0);
  PreparedScene prepared = everything();
  const std::unique_ptr<Simulation> simulation = simulation_of(prepared, ranks, true);
  try {
    simulation->advance(kTimes[1], go_on);
  } catch (const SolverFailure& failure) {
    found = failure.what();
  }
  EXPECT_NE(expected, "");
  EXPECT_EQ(expected, found);
  EXPECT_GT(simulation->liquid().record().particles.density.size(), 100u);
}

TEST(DistantLiquid, WhatIsWrongAtTheStartIsToldOnce) {
  RankBoard board(3);
  std::vector<std::jthread> others;
  for (const int rank : {1, 2})
    others.emplace_back([&board, rank] {
      ThreadRanks ranks(board, rank);
      ranks.next_order();
      PreparedScene prepared = everything();
      prepared.start.position[0] = {0, -0.1, 0};  // in the wall
      serve_liquid(std::move(prepared), set_apart(ranks));
    });
  ThreadRanks ranks(board, 0);
  const PreparedScene prepared = everything();
  try {
    const DistantLiquid liquid(prepared, set_apart(ranks));
    FAIL() << "nothing is wrong";
  } catch (const InvalidInput& error) {
    EXPECT_NE(std::string(error.what()).find("is inside a wall"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace kappaflow
