// Frames of other simulators: which files belong together, what is read from them, and what is wrong with
// them.
#include <algorithm>
#include <map>

#include "core/errors.h"
#include "tests/tools/scratch.h"
#include "tests/tools/sequence_files.h"
#include "tools/data_files.h"
#include "tools/file_series.h"
#include "tools/files.h"
#include "tools/input_frame.h"
#include "tools/particle_sequence.h"

namespace kappaflow {
namespace {

namespace fs = std::filesystem;

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

TEST_F(Sequence, FilesSortByTheirNumber) {
  for (const char* name : {"p_10.csv", "p_9.csv", "p_11.csv", "p_8.csv"}) file(name, "");
  const FileSeries found = series("p_*.csv");
  std::vector<std::string> names;
  for (const fs::path& f : found.files) names.push_back(f.filename());
  EXPECT_EQ(names, (std::vector<std::string>{"p_8.csv", "p_9.csv", "p_10.csv", "p_11.csv"}));
  EXPECT_EQ(found.name, "p");
  EXPECT_EQ(found.gap, "");
  EXPECT_EQ(file_series(std::vector{path("p_9.csv"), path("p_8.csv")}).files.front(), path("p_8.csv"));
}

/// Where the particle of each id is and how fast, of a file of SPlisHSPlasH's.
std::map<std::int64_t, std::pair<Vec3, Vec3>> by_id(const char* name) {
  const InputFrame frame =
      read_input_frame(fs::path(KAPPAFLOW_SOURCE_DIR "/tests/data/splishsplash/bgeo") / name);
  EXPECT_EQ(frame.density.size(), frame.position.size());
  std::map<std::int64_t, std::pair<Vec3, Vec3>> particles;
  for (std::size_t i = 0; i < frame.position.size(); ++i)
    particles[frame.id.at(i)] = {frame.position[i], frame.velocity.at(i)};
  return particles;
}

TEST_F(Sequence, PartiosFilesHoldWhatTheSameSimulatorsVtkFilesHold) {
  const auto partio = by_id("ParticleData_Fluid_2.bgeo"), vtk = by_id("ParticleData_Fluid_2.vtk");
  EXPECT_EQ(partio.size(), 80u);
  EXPECT_EQ(partio, vtk);
}

TEST_F(Sequence, DamagedPartioFilesAreSaid) {
  const std::string whole =
      read_file(fs::path(KAPPAFLOW_SOURCE_DIR "/tests/data/splishsplash/bgeo/ParticleData_Fluid_2.bgeo"));
  const auto complains = [&](const std::string& content) {
    const fs::path damaged = file("damaged.bgeo", content);
    const std::string message = message_of<IoError>([&] { read_input_frame(damaged); });
    EXPECT_TRUE(message.starts_with(damaged.string())) << message;
    return message.substr(std::min(message.size(), damaged.string().size()));
  };
  EXPECT_EQ(complains("id,x,y,z\n"), ": is no .bgeo file of version 5");
  EXPECT_EQ(complains(std::string("BgeoV\0\0\0\4", 9)), ": is of version 4; .bgeo is read in version 5");
  for (const std::size_t share : {0, 1, 2, 3}) {
    const std::string message = complains(whole.substr(0, share * whole.size() / 4));
    EXPECT_EQ(message, ": is damaged or not complete (it ends early)") << share;
  }
  std::string unknown = std::string("BgeoV\0\0\0\5", 9) + std::string(16, '\0');
  unknown += std::string("\0\0\0\1", 4) + std::string(12, '\0');  // one attribute
  unknown += std::string("\0\2id\0\1\0\0\0\7", 10);               // of type 7
  EXPECT_EQ(complains(unknown), ": is damaged or not complete (attribute \"id\" is of the unknown type 7)");
}

TEST_F(Sequence, FilesThatAreNoSeriesAreSaid) {
  for (const char* name : {"a_1.csv", "a_2.csv", "a_4.csv", "b_1.csv", "a_01.csv", "lone_1.csv"})
    file(name, "");
  EXPECT_EQ(series("a_[124].csv").gap, "a file is missing: " + path("a_4.csv") + " comes after " +
                                           path("a_2.csv") + ", and elsewhere the number goes up by 1");
  EXPECT_NE(message_of<InvalidInput>([&] { series("?_1.csv"); }).find(" belong to different series; "),
            std::string::npos);
  EXPECT_NE(message_of<InvalidInput>([&] { series("a_*1.csv"); }).find(" have the same number"),
            std::string::npos);
  EXPECT_EQ(message_of<InvalidInput>([&] { series("lone_*.csv"); }),
            path("lone_1.csv") + " is one file; a sequence takes two or more");
  EXPECT_EQ(message_of<InvalidInput>([&] { series(""); }),
            path("") + " is a folder; name the files in it, e.g. '" + path("") + "/*.vtk'");
  EXPECT_EQ(message_of<IoError>([&] { series("none_*.csv"); }),
            path("none_*.csv") + ": there is no such file");
}

TEST_F(Sequence, EveryFormatHoldsTheSameParticles) {
  const Particles body = moved_block(kBodyMotion, 0.3), shuffled = permuted(body, 1);
  const std::vector<float> density(body.size(), 1000), pressure(body.size(), 5);
  const std::vector<double> weight(body.size(), 1);
  std::vector<int> source(body.size(), -1);
  source[5] = 12;
  write_vtp(folder / "kappaflow.vtp", *particle_data({body, density, pressure, source, weight, 0.2}));
  const std::vector<std::pair<fs::path, Particles>> files{
      {folder / "kappaflow.vtp", body},
      {file("splishsplash.vtk", splishsplash_text(shuffled)), shuffled},
      {file("dualsphysics.vtk", dualsphysics_text(shuffled)), shuffled},
      {file("pysph.vtu", pysph_text(shuffled)), shuffled},
      {file("table.csv", csv_text(shuffled, true, true)), shuffled}};
  for (const auto& [name, expected] : files) {
    const InputFrame frame = read_input_frame(name);
    EXPECT_EQ(frame.id, expected.id) << name;
    ASSERT_EQ(frame.position.size(), expected.size()) << name;
    ASSERT_EQ(frame.velocity.size(), expected.size()) << name;
    for (std::size_t i = 0; i < expected.size(); ++i) {
      EXPECT_LT((frame.position[i] - expected.position[i]).norm(), 1e-7) << name << " " << i;
      EXPECT_LT((frame.velocity[i] - expected.velocity[i]).norm(), 2e-7) << name << " " << i;
    }
  }
  EXPECT_EQ(read_input_frame(folder / "kappaflow.vtp").time, 0.3);
  EXPECT_EQ(read_input_frame(folder / "kappaflow.vtp").pressure, pressure);
  EXPECT_EQ(read_input_frame(folder / "kappaflow.vtp").source, source);
  EXPECT_TRUE(read_input_frame(folder / "pysph.vtu").source.empty());
  EXPECT_EQ(read_input_frame(folder / "splishsplash.vtk").density, density);
  EXPECT_EQ(read_input_frame(folder / "dualsphysics.vtk").density, density);
  EXPECT_EQ(read_input_frame(folder / "dualsphysics.vtk").left_out, 2u) << "of the wall";
  EXPECT_EQ(read_input_frame(folder / "pysph.vtu").left_out, 1u) << "the ghost";
  EXPECT_EQ(read_input_frame(folder / "pysph.vtu").velocity_name, "u, v, w");
  EXPECT_EQ(read_input_frame(folder / "table.csv").time, std::nullopt);
}

TEST_F(Sequence, ATruncatedFileIsOneLineWhereverItEnds) {
  const Particles body = moved_block(kBodyMotion, 0);
  const std::vector<std::pair<std::string, std::string>> files{
      {"a.vtk", splishsplash_text(body)}, {"b.vtk", dualsphysics_text(body)}, {"c.vtu", pysph_text(body)}};
  testing::internal::CaptureStderr();
  for (const auto& [name, whole] : files)
    for (std::size_t size = 0; size + 2 < whole.size(); size += 211) {
      const fs::path cut = file(name, whole.substr(0, size));
      try {
        // An array that the file has come to its end before is missing: said when it is compared to the
        // others.
        const InputFrame frame = read_input_frame(cut);
        EXPECT_TRUE(frame.velocity.empty() || frame.density.empty()) << name << " cut at " << size;
      } catch (const Error& error) {
        EXPECT_TRUE(std::string(error.what()).starts_with(cut.string() + ": ")) << error.what();
        EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
      }
    }
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "") << "VTK prints nothing of its own";
}

TEST_F(Sequence, WrongFilesAreSaidInOneLine) {
  const auto complains = [&](const std::string& name, const std::string& bytes) {
    const fs::path wrong = file(name, bytes);
    const std::string message = message_of<Error>([&] { read_input_frame(wrong); });
    EXPECT_TRUE(message.starts_with(wrong.string() + ":")) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    return message.substr(wrong.string().size());
  };
  EXPECT_EQ(complains("a.csv", "id,x,y,z\n7,1,2,3\n8,1,nan,3\n"),
            ":3:5: found \"nan\"; expected a finite number");
  EXPECT_EQ(complains("a.csv", "id,x,y,z\n7.5,1,2,3\n"), ": the id 7.5 is not a whole number below 2^53");
  EXPECT_EQ(complains("a.csv", "id,x,y,z\n7,1,2\n"), ":2: found 3 values; expected 4");
  EXPECT_EQ(complains("a.csv", "a,b\n1,2\n"), ":1: found the header \"a,b\"; expected \"x,y,z\"");
  EXPECT_EQ(complains("a.csv", "x,y,z\n"), ": holds no particles");
  EXPECT_EQ(complains("a.xyz", ""),
            ": unknown kind of particle file; expected .vtk, .vtp, .vtu, .bgeo or .csv");
  Particles odd = moved_block(kBodyMotion, 0);
  odd.position[2] = Vec3(0, std::nan(""), 1);
  EXPECT_EQ(complains("a.vtk", splishsplash_text(odd)),
            ": the position of particle 11 is (0, nan, 1); it must be finite");
  odd.position[2] = Vec3::Zero();
  odd.velocity[1] = Vec3(0, 0, 1.0 / 0.0);
  EXPECT_EQ(complains("a.vtk", splishsplash_text(odd)),
            ": the velocity of particle 8 is (0, 0, inf); it must be finite");
  EXPECT_THROW(read_input_frame(folder / "none.vtk"), IoError);
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
  EXPECT_EQ(complaint("gap_*.csv"), "a file is missing: " + path("gap_5.csv") + " comes after " +
                                        path("gap_3.csv") + ", and elsewhere the number goes up by 1");
  EXPECT_EQ(complaint("v_0*.csv"), path("v_0.csv") + " is one file; a sequence takes two or more");
  for (const double time : {0.5, 0.25}) {
    Particles at = body;
    at.time = time;
    const std::vector<double> weight(body.size(), 1);
    write_vtp(folder / fmt::format("t_{}.vtp", time < 0.5 ? 1 : 0),
              *particle_data({at, {}, {}, {}, weight, 0.2}));
  }
  EXPECT_EQ(complaint("t_*.vtp"),
            path("t_1.vtp") + ": its time, 0.25 s, is not after that of the file before, 0.5 s");
}

}  // namespace
}  // namespace kappaflow
