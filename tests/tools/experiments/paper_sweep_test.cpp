#include "tools/experiments/paper_sweep.h"

#include <tbb/global_control.h>

#include "core/errors.h"
#include "tests/tools/scratch.h"

namespace kappaflow {
namespace {

const std::string kTracking = "[tracking]\nspeed_limit = 4\nprojection_tolerance = 1e-6\n";
const std::string kThree =
    "[three]\nturns = 1\nedge_length = [0.3]\nsteps_per_turn = [8]\n[[three.map]]\nname = \"a\"\ntitle = "
    "\"A\"\nx = \"radius\"\n"
    "y = \"sigma\"\nradius = [0.2, 0.5]\nsigma = [1, 0.01]\nfairing_iterations = [0, 2]\n";
const std::string kOne =
    "[one]\nturns = 2\nedge_length = [0.3]\nsteps_per_turn = [8]\n[[one.map]]\nname = \"b\"\ntitle = "
    "\"B\"\nx = \"tolerance\"\n"
    "y = \"start\"\nminimiser = [\"powell\"]\n[one.map.quick]\ntolerance = [0, 0.5]\n";

class PaperSweeps : public Scratch {
 protected:
  std::vector<PaperSweep> read(const std::string& text, bool quick = false) const {
    return read_paper_sweeps(file("map.toml", text), quick);
  }
  std::string mistake(const std::string& text) const {
    return message_of<InvalidInput>([&] { read(text); });
  }
};

TEST_F(PaperSweeps, HaveEveryCombination) {
  const std::vector<PaperSweep> sweeps = read(kTracking + kThree + kOne);
  ASSERT_EQ(sweeps.size(), 2u);
  const std::vector<PaperResult>& three = sweeps[0].maps.front().results;
  ASSERT_EQ(three.size(), 8u);
  EXPECT_EQ(three[1].setting.fairing_iterations, 2) << "the last choice first";
  EXPECT_EQ(three[2].setting.radius, 0.5);
  EXPECT_EQ(three[7].setting.sigma, 0.01);
  for (const PaperResult& r : three) EXPECT_EQ(r.setting.steps_per_turn, 8) << "of the wider table";
  EXPECT_EQ(sweeps[1].maps.front().results.size(), 1u);
  EXPECT_EQ(read(kTracking + kThree + kOne, true)[1].maps.front().results.size(), 2u);
}

TEST_F(PaperSweeps, MistakesAreNamedWithTheirPlace) {
  const auto replaced = [](std::string text, const std::string& from, const std::string& to) {
    return text.replace(text.find(from), from.size(), to);
  };
  const std::string good = kTracking + kThree + kOne;
  EXPECT_NE(mistake(replaced(good, "x = \"radius\"", "x = \"radios\"")).find("map.toml:11:5: x in "),
            std::string::npos);
  EXPECT_NE(mistake(replaced(good, "radius = [0.2, 0.5]", "radius = []")).find("an array of one or more"),
            std::string::npos);
  EXPECT_NE(mistake(replaced(good, "[\"powell\"]", "[\"powel\"]")).find("did you mean \"powell\"?"),
            std::string::npos);
  EXPECT_NE(mistake(replaced(good, "y = \"sigma\"\n", "")).find("y"), std::string::npos);
  EXPECT_NE(mistake(replaced(good, "sigma = [1, 0.01]", "sigmas = [1]")).find("unknown key \"sigmas\""),
            std::string::npos);
}

TEST_F(PaperSweeps, HaveTheSameBitsWithAnyNumberOfThreads) {
  const std::filesystem::path path = file("map.toml", kTracking + kThree + kOne);
  ExperimentOptions options;
  options.quiet = true;
  std::vector<double> errors[2];
  for (const std::size_t threads : {1, 4}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    for (PaperSweep& sweep : read_paper_sweeps(path, false)) {
      run_paper_sweep(sweep, {options, path, folder, "paper-map"});
      for (const PaperResult& r : sweep.maps.front().results)
        for (const double error : {r.total.end(), r.curvature.end(), r.total.over_run, r.curvature.over_run})
          errors[threads / 4].push_back(error);
    }
  }
  EXPECT_EQ(errors[0], errors[1]);
  EXPECT_EQ(errors[0].size(), 36u);
  EXPECT_EQ(errors[0][0], errors[0][16]) << "total does not know the unit of length";
  EXPECT_NE(errors[0][1], errors[0][17]);
}

}  // namespace
}  // namespace kappaflow
