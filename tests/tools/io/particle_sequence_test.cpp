// Frames of other simulators as one motion: which particle is which, how fast it is, and what does not fit.
#include "tools/io/particle_sequence.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "core/errors.h"
#include "tests/tools/scratch.h"
#include "tests/tools/sequence_files.h"
#include "tools/io/particle_survey.h"
#include "tools/io/vtp_files.h"

namespace kappaflow {
namespace {

class Sequence : public Scratch {
 protected:
  FileSeries series(const std::string& pattern) const {
    return file_series(std::vector<std::string>{(folder / pattern).string()});
  }
  std::string path(const std::string& name) const { return (folder / name).string(); }
  /// What opening the files says is wrong with them.
  std::string complaint(const std::string& pattern, std::optional<double> fps = 10) const {
    return message_of<InvalidInput>([&] { ParticleSequence(series(pattern), fps); });
  }
};

TEST_F(Sequence, DecimalNumbersSuggestAFrameRate) {
  for (const char* number : {"0.0", "0.5", "1.0", "1.5"})
    file(fmt::format("p_{}.csv", number), csv_text(moved_block({}, 0), true, false));
  EXPECT_EQ(complaint("p_*.csv", std::nullopt),
            "p: the files hold no times; say how many frames a second they are by --fps (2 if the names hold "
            "seconds)");
  EXPECT_DOUBLE_EQ(ParticleSequence(series("p_*.csv"), 2).time(3), 1.5);
}

TEST_F(Sequence, PermutedIdsAreSorted) {
  for (const int k : {0, 1, 2})
    file(fmt::format("p_{}.vtk", k), splishsplash_text(permuted(moved_block(kBodyMotion, 0.1 * k), k)));
  ParticleSequence sequence(series("p_*.vtk"), 10);
  EXPECT_TRUE(sequence.matched());
  EXPECT_EQ(sequence.velocity(), ParticleSequence::Velocity::given);
  for (const int k : {0, 1, 2}) {
    const Particles expected = moved_block(kBodyMotion, 0.1 * k), found = sequence.frame(k).particles;
    EXPECT_EQ(found.id, expected.id);
    EXPECT_DOUBLE_EQ(found.time, 0.1 * k);
    for (std::size_t i = 0; i < expected.size(); ++i)
      EXPECT_LT((found.position[i] - expected.position[i]).norm(), 1e-7);
  }
  for (const std::string& note : sequence.notes())
    EXPECT_EQ(note.find("velocities and displacements fit"), std::string::npos) << "the rate is right";
}

TEST_F(Sequence, HashTellsParticlesApart) {
  const auto hash_of = [&](double moved) {
    for (const int k : {0, 1}) {
      Particles body = moved_block(kBodyMotion, 0.1 * k);
      if (k == 1) body.position[7].z() += moved;
      file(fmt::format("p_{}.csv", k), csv_text(body, true, true));
    }
    return ParticleSequence(series("p_*.csv"), 10).hash();
  };
  const std::string hash = hash_of(0);
  EXPECT_EQ(hash, hash_of(0));
  EXPECT_NE(hash, hash_of(1e-12));
}

/// A legacy VTK file of four particles with ids 3, 2, 1, 0 and these sources.
std::string four_with_sources(const std::string& sources) {
  return "# vtk DataFile Version 3.0\nfour\nASCII\nDATASET POLYDATA\nPOINTS 4 double\n"
         "0 0 0 1 0 0 0 1 0 0 0 1\nPOINT_DATA 4\nFIELD all 2\nid 1 4 int\n3 2 1 0\nSource 1 4 double\n" +
         sources + "\n";
}

TEST_F(Sequence, SourcesAreWholeNumbersInTheOrderOfTheIds) {
  for (const int k : {0, 1}) file(fmt::format("s_{}.vtk", k), four_with_sources("10 20 30 -1"));
  EXPECT_EQ(ParticleSequence(series("s_*.vtk"), 10).frame(1).source, (std::vector<int>{-1, 30, 20, 10}));
  for (const char* something_else : {"0 1 2 0.5", "0 0 0 3e9", "0 0 0 nan"})
    EXPECT_TRUE(read_input_frame(file("h.vtk", four_with_sources(something_else))).source.empty());
}

TEST_F(Sequence, AWrongFrameRateIsNoticed) {
  for (const int k : {0, 1, 2})
    file(fmt::format("p_{}.vtk", k), splishsplash_text(moved_block({.velocity = {1, 0, 0}}, 0.1 * k)));
  const std::vector<std::string> notes = ParticleSequence(series("p_*.vtk"), 25).notes();
  EXPECT_EQ(std::ranges::count(notes, "velocities and displacements fit 10 frames a second, not 25"), 1);
  EXPECT_EQ(complaint("p_*.vtk", std::nullopt),
            "p: the files hold no times; say how many frames a second they are by --fps (velocities and "
            "displacements fit 10)");
}

TEST_F(Sequence, BackwardVelocitiesHaveTheOtherSign) {
  for (const int k : {0, 1, 2})
    file(fmt::format("p_{}.csv", k), csv_text(moved_block(kBodyMotion, 0.1 * k), true, true));
  ParticleSequence sequence(file_series(std::vector{path("p_*.csv")}, {0, 9, 1, true}), 10);
  for (const int k : {0, 1, 2}) {
    const Particles expected = moved_block(kBodyMotion, 0.1 * (2 - k)), found = sequence.frame(k).particles;
    EXPECT_DOUBLE_EQ(found.time, 0.1 * k);
    for (std::size_t i = 0; i < expected.size(); ++i) {
      EXPECT_EQ(found.position[i], expected.position[i]);
      EXPECT_EQ(found.velocity[i], -expected.velocity[i]);
    }
  }
  for (const std::string& note : sequence.notes())
    EXPECT_EQ(note.find("displacements"), std::string::npos) << note;
}

// x(t) = x0 + v t + a t^2/2 with another v and a for each particle, which a parabola follows exactly.
TEST_F(Sequence, EstimatedVelocitiesAreExactForParabolas) {
  const auto velocity = [](std::int64_t id, double t) {
    return Vec3(1 + static_cast<double>(id), -0.5 * t, 2 * static_cast<double>(id) * t);
  };
  for (const int k : {0, 1, 2, 3}) {
    Particles p;
    for (const std::int64_t id : {4, 1, 3, 2}) {
      if (id == 4 && k == 0) continue;  // appears at k = 1
      const double t = 0.1 * k, d = static_cast<double>(id);
      p.id.push_back(id);
      p.position.emplace_back((1 + d) * t, -0.25 * t * t, d * t * t);
      p.velocity.push_back(Vec3::Zero());
    }
    file(fmt::format("p_{}.csv", k), csv_text(p, true, false));
  }
  ParticleSequence sequence(series("p_*.csv"), 10);
  EXPECT_EQ(sequence.velocity(), ParticleSequence::Velocity::estimated);
  for (const int k : {0, 1, 2, 3}) {
    const Particles p = sequence.frame(k).particles;
    ASSERT_EQ(p.size(), k == 0 ? 3u : 4u);
    for (std::size_t i = 0; i < p.size(); ++i) {
      // The particle that appears at k = 1 is known in two of the frames around it: a line, right in its
      // middle.
      const double t = p.id[i] == 4 && k == 1 ? 0.15 : 0.1 * k;
      EXPECT_LT((p.velocity[i] - velocity(p.id[i], t)).norm(), 1e-12) << k << " " << p.id[i];
    }
  }
}

TEST_F(Sequence, RepeatedIdsAreNoticedAndNotUsed) {
  Particles body = moved_block(kBodyMotion, 0);
  std::ranges::fill(body.id, 4294967295);
  file("p_0.vtu", pysph_text(body));
  file("p_1.vtu", pysph_text(body));
  ParticleSequence sequence(series("p_*.vtu"), 10);
  EXPECT_FALSE(sequence.matched());
  EXPECT_EQ(sequence.velocity(), ParticleSequence::Velocity::given);
  EXPECT_EQ(std::ranges::count(sequence.notes(), "ids \"gid\" cannot be used: " + path("p_0.vtu") +
                                                     " has several particles with the id 4294967295"),
            1);
  const Particles first = sequence.frame(0).particles, second = sequence.frame(1).particles;
  EXPECT_LT(first.id.back(), second.id.front()) << "no particle is taken for another";
}

TEST_F(Sequence, StepsOtherThanOneAreSaid) {
  for (const int k : {1, 3, 5}) file(fmt::format("p_{}.csv", k), csv_text(moved_block({}, 0), true, false));
  const auto said = [&](double fps) {
    return std::ranges::count(ParticleSequence(series("p_*.csv"), fps).notes(),
                              "numbers go up by 2: taken as consecutive frames, 0.04 s apart");
  };
  EXPECT_EQ(said(25), 1);
}

/// What is noted of the ids in frames 0.1 s apart, without velocities.
class Ids : public Sequence {
 protected:
  template <class Frame>
  std::vector<std::string> notes(const Frame& frame, bool velocities = false) {
    for (const int k : {0, 1, 2}) file(fmt::format("p_{}.csv", k), csv_text(frame(k), true, velocities));
    std::vector<std::string> found = ParticleSequence(series("p_*.csv"), 10).notes();
    std::erase_if(found, [](const std::string& note) { return note.find("do the ids follow") == note.npos; });
    return found;
  }
};

TEST_F(Ids, ThatFollowTheParticlesAreNotNoted) {
  const SteadyMotion fast{.velocity = {50, 20, 0}},
      turning{.velocity = {1, 0, 0}, .angular_velocity = {0, 5, 5}};
  for (const SteadyMotion& motion : {SteadyMotion{}, kBodyMotion, fast, turning})
    EXPECT_EQ(notes([&](int k) { return permuted(moved_block(motion, 0.1 * k), k); }),
              std::vector<std::string>());
}

TEST_F(Ids, OfRowsWhoseOrderChangesAreNoted) {
  for (const SteadyMotion& motion : {SteadyMotion{}, kBodyMotion, SteadyMotion{.velocity = {50, 20, 0}}}) {
    const auto found = notes([&](int k) {
      Particles p = permuted(moved_block(motion, 0.1 * k), k);
      std::iota(p.id.begin(), p.id.end(), std::int64_t{0});
      return p;
    });
    ASSERT_EQ(found.size(), 1u);
    const std::string frames = fmt::format("from {} to {} ", path("p_0.csv"), path("p_1.csv"));
    EXPECT_TRUE(found[0].starts_with(frames + "particles part from their neighbours by ")) << found[0];
    EXPECT_TRUE(found[0].ends_with(" spacings: do the ids follow the particles?")) << found[0];
  }
}

/// Of large frames some particles are asked.
TEST_F(Ids, OfLargeFramesAreNotedLikewise) {
  const auto frame = [](int k, bool follow) {
    Particles p;
    for (int i = 0; i < 42000; ++i) {
      p.id.push_back(i);
      p.position.push_back(kBodySpacing * Vec3(i % 35 + 3 * k, i / 35 % 40, i / 1400));
    }
    if (!follow && k == 1) std::shuffle(p.id.begin(), p.id.end(), std::mt19937(1));
    return p;
  };
  EXPECT_EQ(notes([&](int k) { return frame(k, true); }), std::vector<std::string>());
  EXPECT_EQ(notes([&](int k) { return frame(k, false); }).size(), 1u);
}

TEST(Coincident, ParticlesAreCountedAsByComparingAll) {
  std::mt19937 random(3);
  std::uniform_int_distribution<int> place(-3, 3);
  for (int round = 0; round < 20; ++round) {
    std::vector<Vec3> position;
    for (int i = 0; i < 100; ++i) position.emplace_back(place(random), place(random), place(random));
    for (Vec3& x : position)
      if (x.z() == 0 && place(random) > 0) x.z() = -0.0;
    Coincidence expected;
    for (std::size_t i = 0; i < position.size(); ++i)
      for (std::size_t j = 0; j < i; ++j) {
        if (position[i] != position[j]) continue;
        if (expected.count++ == 0) expected.first = j, expected.second = i;
        break;
      }
    const Coincidence found = coincident_particles(position);
    EXPECT_GT(expected.count, 0u);
    EXPECT_EQ(found.count, expected.count);
    EXPECT_EQ(found.first, expected.first);
    EXPECT_EQ(found.second, expected.second);
  }
}

TEST_F(Ids, ThatAreInOneFrameOnlyAreNoted) {
  const auto found = notes([](int k) {
    Particles p = moved_block(kBodyMotion, 0.1 * k);
    for (std::int64_t& id : p.id) id += 1000 * k;
    return p;
  });
  EXPECT_EQ(found,
            (std::vector<std::string>{fmt::format("no id of {} is in {}: do the ids follow the particles?",
                                                  path("p_0.csv"), path("p_1.csv"))}));
}

TEST_F(Ids, OfParticlesInOnePlaceAreNoted) {
  Particles body = moved_block({}, 0);
  body.position[4] = body.position[2];
  body.position[7] = body.position[2];
  for (const int k : {0, 1}) file(fmt::format("p_{}.csv", k), csv_text(body, true, false));
  const std::vector<std::string> found = ParticleSequence(series("p_*.csv"), 10).notes();
  EXPECT_EQ(std::ranges::count(found,
                               "2 particles of " + path("p_0.csv") + " are where others are, e.g. 11 and 17"),
            1);
}

TEST_F(Sequence, FramesThatDoNotFitTogetherAreSaid) {
  const Particles body = moved_block(kBodyMotion, 0);
  file("ids_0.csv", csv_text(body, true, false));
  file("ids_1.csv", csv_text(body, false, false));
  EXPECT_EQ(complaint("ids_*.csv"),
            path("ids_1.csv") + ": has no ids; " + path("ids_0.csv") + " has them (\"id\")");
  file("v_0.csv", csv_text(body, true, false));
  file("v_1.csv", csv_text(body, true, true));
  EXPECT_EQ(complaint("v_*.csv"),
            path("v_0.csv") + ": has no velocities; " + path("v_1.csv") + " has them (\"vx, vy, vz\")");
  for (const int k : {1, 2, 3, 5}) file(fmt::format("gap_{}.csv", k), csv_text(body, true, false));
  EXPECT_EQ(complaint("gap_*.csv"),
            "a file is missing: " + path("gap_5.csv") + " comes after " + path("gap_3.csv") +
                ", and elsewhere the number goes up by 1; files without times must be "
                "equally far apart");
  EXPECT_EQ(complaint("v_0*.csv"), path("v_0.csv") + " is one file; a sequence takes two or more");
  for (const double time : {0.5, 0.25}) {
    Particles at = body;
    at.time = time;
    const std::vector<double> weight(body.size(), 1);
    write_vtp(folder / fmt::format("t_{}.vtp", time < 0.5 ? 1 : 0),
              *particle_data({at, {}, {}, {}}, weight, 0.2));
  }
  EXPECT_EQ(complaint("t_*.vtp"),
            path("t_1.vtp") + ": its time, 0.25 s, is not after that of the file before, 0.5 s");
}

}  // namespace
}  // namespace kappaflow
