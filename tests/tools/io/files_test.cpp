#include "tools/io/files.h"

#include "core/errors.h"
#include "core/read_file.h"
#include "scenes/mesh_file.h"
#include "scenes/scene.h"
#include "tests/tools/full_disk.h"
#include "tests/tools/scratch.h"
#include "tools/io/input_frame.h"

namespace kappaflow {
namespace {

namespace fs = std::filesystem;

class Files : public Scratch {};

TEST_F(Files, WriteReplacesAndLeavesNothingElse) {
  write_file(folder / "a", "first, and longer");
  write_file(folder / "a", std::string_view("second\0\n", 8));
  EXPECT_EQ(read_file(folder / "a"), std::string("second\0\n", 8));
  EXPECT_EQ(std::distance(fs::directory_iterator(folder), {}), 1);
}

TEST_F(Files, FailedWriteKeepsTheOldFile) {
  write_file(folder / "a", "old");
  const std::string large(100000, 'x');
  std::string message;
  {
    const FullDisk full(4096);
    message = message_of<IoError>([&] { write_file(folder / "a", large); });
  }
  EXPECT_NE(message.find((folder / "a").string() + ": 100000 bytes cannot be written ("), std::string::npos)
      << message;
  EXPECT_EQ(read_file(folder / "a"), "old");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder), {}), 1) << "the temporary file is gone";
}

TEST_F(Files, FailedAppendLeavesWholeLines) {
  write_file(folder / "a", "line 1\n");
  append_lines(folder / "a", "line 2\n");
  {
    const FullDisk full(4096);
    EXPECT_THROW(append_lines(folder / "a", std::string(100000, 'x') + "\n"), IoError);
  }
  EXPECT_EQ(read_file(folder / "a"), "line 1\nline 2\n");
}

TEST_F(Files, DurableWriteIsWholeOrNotAtAll) {
  write_file_durably(folder / "a", {"ol", "d"});
  {
    const FullDisk full(4096);
    EXPECT_THROW(write_file_durably(folder / "a", {std::string(100000, 'x')}), IoError);
  }
  EXPECT_EQ(read_file(folder / "a"), "old");
  EXPECT_THROW(flush_to_disk(folder / "none"), IoError);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder), {}), 1);
}

TEST_F(Files, CutsBackButNeverLengthens) {
  write_file(folder / "a", "line 1\nline 2\nhalf a li");
  EXPECT_EQ(message_of<IoError>([&] { cut_to_lines(folder / "a", 3); }),
            (folder / "a").string() + ": has 2 lines; it had 3");
  cut_to_lines(folder / "a", 2);
  EXPECT_EQ(read_file(folder / "a"), "line 1\nline 2\n");
  cut_to_lines(folder / "a", 1);
  EXPECT_EQ(read_file(folder / "a"), "line 1\n");
}

/// A file whose first byte cannot be read, as on a disk that fails: nothing is mapped at address 0.
TEST_F(Files, AFailedReadIsNotTheEndOfTheFile) {
  fs::create_symlink("/proc/self/mem", folder / "bad");
  EXPECT_EQ(message_of<IoError>([&] { read_file(folder / "bad"); }),
            (folder / "bad").string() + ": cannot be read (Input/output error)");
  EXPECT_EQ(message_of<IoError>([&] { read_file(folder); }),
            folder.string() + ": cannot be read (Is a directory)");
  for (const char* name : {"bad.vtk", "bad.vtp", "bad.vtu", "bad.csv", "bad.bgeo", "bad.hdf5"}) {
    fs::create_symlink("/proc/self/mem", folder / name);
    EXPECT_EQ(message_of<IoError>([&] { read_input_frame(folder / name); }),
              (folder / name).string() + ": cannot be read (Input/output error)");
  }
  fs::create_symlink("/proc/self/mem", folder / "bad.toml");
  EXPECT_EQ(
      message_of<InvalidInput>([&] { load_scene(folder / "bad.toml"); }),
      (folder / "bad.toml").string() + ": the file cannot be read; allowed: a readable scene file (.toml)");
  fs::create_symlink("/proc/self/mem", folder / "bad.stl");
  EXPECT_NE(message_of<InvalidInput>([&] {
              read_closed_mesh(folder / "bad.stl", {"scene.toml", 3, 1});
            }).find("bad.stl\" cannot be read; allowed: "),
            std::string::npos);
}

TEST_F(Files, MissingPlacesAreReported) {
  EXPECT_THROW(write_file(folder / "none" / "a", ""), IoError);
  EXPECT_THROW(append_lines(folder / "none", "a\n"), IoError);
  EXPECT_THROW(read_file(folder / "none"), IoError);
  EXPECT_THROW(read_file(folder), IoError);
  file("a", "");
  EXPECT_THROW(make_folder(folder / "a" / "b"), IoError);
}

}  // namespace
}  // namespace kappaflow
