// Frames of other simulators: which files belong together, what is read from them, and what is wrong with
// them.
#include <algorithm>
#include <cstdlib>
#include <map>
#include <numeric>

#include "core/errors.h"
#include "tests/tools/scratch.h"
#include "tests/tools/sequence_files.h"
#include "tools/io/file_series.h"
#include "tools/io/files.h"
#include "tools/io/input_frame.h"
#include "tools/io/particle_sequence.h"
#include "tools/io/vtp_files.h"

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

TEST_F(Sequence, AGapIsWhereTheStepIsNotTheMostFrequent) {
  const auto gap = [&](std::initializer_list<const char*> numbers) {
    std::vector<std::string> names;
    for (const char* number : numbers) names.push_back(file(fmt::format("p_{}.csv", number), ""));
    return file_series(names).gap;
  };
  const auto says = [&](const char* how, const char* after, const char* before, const char* step) {
    return fmt::format("{}: {} comes after {}, and elsewhere the number goes up by {}", how,
                       path(fmt::format("p_{}.csv", after)), path(fmt::format("p_{}.csv", before)), step);
  };
  const char *const missing = "a file is missing", *const uneven = "the frames are not equally far apart";
  EXPECT_EQ(gap({"0", "100", "200"}), "");
  EXPECT_EQ(gap({"0", "100", "187"}), says(uneven, "187", "100", "100")) << "PySPH's last step";
  EXPECT_EQ(gap({"0", "100", "200", "300", "350"}), says(uneven, "350", "300", "100"));
  EXPECT_EQ(gap({"1", "3", "4"}), says(missing, "3", "1", "1"));
  EXPECT_EQ(gap({"1", "2", "4"}), says(missing, "4", "2", "1"));
  EXPECT_EQ(gap({"0", "2", "3", "5", "7"}), says(uneven, "3", "2", "2"));
  EXPECT_EQ(gap({"0.00", "0.25", "0.5", "1.0"}), says(missing, "1.0", "0.5", "0.25"));
}

TEST_F(Sequence, DecimalNumbersInNamesSortByValue) {
  const auto order = [&](std::initializer_list<const char*> numbers) {
    std::vector<std::string> files, found;
    for (const char* number : numbers) files.push_back(file(fmt::format("run2_{}.csv", number), ""));
    for (const fs::path& f : file_series(files).files)
      found.push_back(f.stem().string().substr(std::string("run2_").size()));
    return found;
  };
  using Names = std::vector<std::string>;
  EXPECT_EQ(order({"0.00", "0.5", "0.10"}), (Names{"0.00", "0.10", "0.5"}));
  EXPECT_EQ(order({"1.5", "0.5", "1.0", "10.0"}), (Names{"0.5", "1.0", "1.5", "10.0"}));
  EXPECT_EQ(order({"1.10", "1.9", "1.8"}), (Names{"1.8", "1.9", "1.10"})) << "counted after a point";
  EXPECT_EQ(order({"1.010", "1.009"}), (Names{"1.009", "1.010"}));
  EXPECT_EQ(order({"3.0", "1.0", "2.0"}), (Names{"1.0", "2.0", "3.0"}));
}

TEST_F(Sequence, DecimalNumbersSuggestAFrameRate) {
  for (const char* number : {"0.0", "0.5", "1.0", "1.5"})
    file(fmt::format("p_{}.csv", number), csv_text(moved_block({}, 0), true, false));
  EXPECT_EQ(complaint("p_*.csv", std::nullopt),
            "p: the files hold no times; say how many frames a second they are by --fps (2 if the names hold "
            "seconds)");
  EXPECT_DOUBLE_EQ(ParticleSequence(series("p_*.csv"), 2).time(3), 1.5);
}

TEST_F(Sequence, FoldersMayHaveAnyCharactersAndATildeIsHome) {
  for (const char* name : {"br[1]", "a*b", "w?", "~", "back\\slash"}) {
    fs::create_directory(folder / name);
    for (const int k : {0, 1, 2}) file(fmt::format("{}/p_{}.csv", name, k), "");
    EXPECT_EQ(series(fmt::format("{}/p_[0-9].csv", name)).files.size(), 3u) << name;
    EXPECT_EQ(series(fmt::format("{}/p_[12].csv", name)).files[0], path(fmt::format("{}/p_1.csv", name)));
  }
  EXPECT_EQ(series("?r*/p_*.csv").files.size(), 3u) << "wildcards of folders that are not there";
  const std::string home = getenv("HOME") == nullptr ? "" : getenv("HOME");
  setenv("HOME", folder.c_str(), 1);
  EXPECT_EQ(file_series(std::vector<std::string>{"~/br[1]/p_*.csv"}).files[0], path("br[1]/p_0.csv"));
  setenv("HOME", home.c_str(), 1);
}

TEST_F(Sequence, NamesThatCannotBeExaminedAreSaid) {
  fs::create_symlink("loop_1.csv", folder / "loop_1.csv");
  const std::string too_long = path(std::string(300, 'x') + ".csv");
  EXPECT_EQ(message_of<IoError>([&] { file_series(std::vector{too_long}); }),
            too_long + ": there is no such file");
  EXPECT_EQ(message_of<IoError>([&] { read_input_frame(folder / "loop_1.csv"); }),
            path("loop_1.csv") + ": cannot be read (Too many levels of symbolic links)");
  EXPECT_THROW(series("loop_1.csv"), Error) << "no std::filesystem::filesystem_error";
}

TEST_F(Sequence, TablesAreReadAsOthersWriteThem) {
  const Particles body = moved_block(kBodyMotion, 0.3);
  std::string paraview =
      "\"velocity:0\",\"velocity:1\",\"velocity:2\",\"ID\",\"Points:0\",\"Points:1\",\"Points:2\"\n";
  std::string semicolons = "\xEF\xBB\xBF u; v; w; name; X; Y; Z; particle_id\r\n";
  for (std::size_t i = 0; i < body.size(); ++i) {
    const Vec3 &x = body.position[i], &v = body.velocity[i];
    paraview += fmt::format("{},{},{},{},{},{},{}\n", v[0], v[1], v[2], body.id[i], x[0], x[1], x[2]);
    semicolons +=
        fmt::format("{}; {}; {}; liquid; {}; {}; {}; {}\r\n", v[0], v[1], v[2], x[0], x[1], x[2], body.id[i]);
  }
  for (const std::string& text : {paraview, semicolons}) {
    const InputFrame frame = read_input_frame(file("table.csv", text));
    EXPECT_EQ(frame.id, body.id);
    EXPECT_EQ(frame.position, body.position);
    EXPECT_EQ(frame.velocity, body.velocity);
  }
  EXPECT_EQ(read_input_frame(file("table.csv", semicolons)).velocity_name, "u, v, w");
  const InputFrame rows = read_input_frame(file("table.csv", "Point ID,x,y,z\n0,1,2,3\n1,4,5,6\n"));
  EXPECT_EQ(rows.id_name, "") << "ParaView's number of a row";
  EXPECT_EQ(rows.position, (std::vector<Vec3>{{1, 2, 3}, {4, 5, 6}}));
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
  EXPECT_EQ(
      complains("a.csv", "a,b\n1,2\n"),
      ":1: found the header \"a,b\"; expected x,y,z or id,x,y,z or x,y,z,vx,vy,vz or id,x,y,z,vx,vy,vz, in "
      "any order, perhaps among others");
  EXPECT_EQ(complains("a.csv", "x,y,z\n"), ": holds no particles");
  EXPECT_EQ(complains("a.xyz", ""),
            ": unknown kind of particle file; expected .vtk, .vtp, .vtu, .bgeo, .hdf5 or .csv");
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
              *particle_data({at, {}, {}, {}, weight, 0.2}));
  }
  EXPECT_EQ(complaint("t_*.vtp"),
            path("t_1.vtp") + ": its time, 0.25 s, is not after that of the file before, 0.5 s");
}

}  // namespace
}  // namespace kappaflow
