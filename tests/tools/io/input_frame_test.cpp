// What is read from one file of particles, and what is wrong with it.
#include "tools/io/input_frame.h"

#include <fmt/format.h>

#include <map>

#include "core/errors.h"
#include "core/read_file.h"
#include "tests/tools/scratch.h"
#include "tests/tools/sequence_files.h"
#include "tools/io/vtp_files.h"

namespace kappaflow {
namespace {

namespace fs = std::filesystem;

class InputFrames : public Scratch {};

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

TEST_F(InputFrames, PartiosFilesHoldWhatTheSameSimulatorsVtkFilesHold) {
  const auto partio = by_id("ParticleData_Fluid_2.bgeo"), vtk = by_id("ParticleData_Fluid_2.vtk");
  EXPECT_EQ(partio.size(), 80u);
  EXPECT_EQ(partio, vtk);
}

TEST_F(InputFrames, DamagedPartioFilesAreSaid) {
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

TEST_F(InputFrames, TablesAreReadAsOthersWriteThem) {
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

TEST_F(InputFrames, EveryFormatHoldsTheSameParticles) {
  const Particles body = moved_block(kBodyMotion, 0.3), shuffled = permuted(body, 1);
  const std::vector<float> density(body.size(), 1000), pressure(body.size(), 5),
      temperature(body.size(), 312.5f);
  const std::vector<double> weight(body.size(), 1);
  std::vector<int> source(body.size(), -1);
  source[5] = 12;
  write_vtp(folder / "kappaflow.vtp",
            *particle_data({body, density, pressure, source, temperature}, weight, 0.2));
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
  EXPECT_EQ(read_input_frame(folder / "kappaflow.vtp").temperature, temperature);
  EXPECT_EQ(read_input_frame(folder / "kappaflow.vtp").source, source);
  EXPECT_TRUE(read_input_frame(folder / "pysph.vtu").source.empty());
  EXPECT_EQ(read_input_frame(folder / "splishsplash.vtk").density, density);
  EXPECT_EQ(read_input_frame(folder / "dualsphysics.vtk").density, density);
  EXPECT_EQ(read_input_frame(folder / "dualsphysics.vtk").left_out, 2u) << "of the wall";
  EXPECT_EQ(read_input_frame(folder / "pysph.vtu").left_out, 1u) << "the ghost";
  EXPECT_EQ(read_input_frame(folder / "pysph.vtu").velocity_name, "u, v, w");
  EXPECT_EQ(read_input_frame(folder / "table.csv").time, std::nullopt);
}

TEST_F(InputFrames, ATruncatedFileIsOneLineWhereverItEnds) {
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

TEST_F(InputFrames, WrongFilesAreSaidInOneLine) {
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
            ": unknown kind of particle file; expected .vtk, .vtp, .vtu, .pvtp, .pvtu, .bgeo, .hdf5 or .csv");
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

TEST_F(InputFrames, AFileThatCannotBeOpenedIsSaid) {
  fs::create_symlink("loop_1.csv", folder / "loop_1.csv");
  EXPECT_EQ(message_of<IoError>([&] { read_input_frame(folder / "loop_1.csv"); }),
            (folder / "loop_1.csv").string() + ": cannot be read (Too many levels of symbolic links)");
}

}  // namespace
}  // namespace kappaflow
