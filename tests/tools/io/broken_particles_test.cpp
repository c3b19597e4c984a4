// Particle files with one mistake each yield one line that says what was found and what is allowed. Those of
// tests/data/particles are frames for `kappaflow track`, those of tests/data/field_particles are for
// `kappaflow probe`; the message stands beside each, in a file that ends with .expected.
#include <set>

#include "core/errors.h"
#include "core/read_file.h"
#include "tests/scenes/scene_files.h"
#include "tools/io/input_frame.h"
#include "tools/io/particle_file.h"

namespace kappaflow {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> broken_files(std::string_view folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(source_file(folder)))
    if (entry.path().extension() != ".expected") files.push_back(entry.path());
  std::ranges::sort(files);
  return files;
}

std::string name_of_test(const testing::TestParamInfo<fs::path>& file) {
  std::string name = file.param.filename();
  std::ranges::replace(name, '.', '_');
  return name;
}

/// What `read` says of the file, after its folder.
template <class Read>
void expect_message(const fs::path& file, const Read& read) {
  testing::internal::CaptureStderr();
  std::string message;
  try {
    read(file);
  } catch (const Error& error) {
    message = error.what();
  }
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "") << "libraries print nothing of their own";
  const std::string folder = file.parent_path().string() + "/";
  ASSERT_TRUE(message.starts_with(folder)) << message;
  EXPECT_EQ(message.substr(folder.size()) + "\n", read_file(file.string() + ".expected"));
}

class BrokenFrame : public testing::TestWithParam<fs::path> {};

TEST_P(BrokenFrame, ReportsTheExpectedLine) {
  expect_message(GetParam(), [](const fs::path& file) { read_input_frame(file); });
}

INSTANTIATE_TEST_SUITE_P(Data, BrokenFrame, testing::ValuesIn(broken_files("tests/data/particles")),
                         name_of_test);

class BrokenFieldParticles : public testing::TestWithParam<fs::path> {};

TEST_P(BrokenFieldParticles, ReportsTheExpectedLine) {
  expect_message(GetParam(), [](const fs::path& file) { read_particle_file(file); });
}

INSTANTIATE_TEST_SUITE_P(Data, BrokenFieldParticles,
                         testing::ValuesIn(broken_files("tests/data/field_particles")), name_of_test);

TEST(BrokenParticles, AreManyOfEveryKind) {
  const std::vector<fs::path> files = broken_files("tests/data/particles");
  std::set<std::string> kinds;
  for (const fs::path& file : files) kinds.insert(file.extension());
  EXPECT_GE(files.size(), 100u);
  EXPECT_EQ(kinds,
            (std::set<std::string>{"", ".bgeo", ".csv", ".hdf5", ".npz", ".vtk", ".vtp", ".vtu", ".xyz"}));
}

TEST(BrokenParticles, AFolderIsNoFile) {
  const fs::path folder = fs::path(testing::TempDir()) / "kappaflow_folder.vtk";
  fs::create_directories(folder);
  for (const char* name : {"kappaflow_folder.vtk", "kappaflow_none.vtp", "kappaflow_none.bgeo"})
    EXPECT_THROW(read_input_frame(fs::path(testing::TempDir()) / name), IoError) << name;
  fs::remove(folder);
}

}  // namespace
}  // namespace kappaflow
