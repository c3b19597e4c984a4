// Files as PySPH writes them.
#include <random>

#include "core/errors.h"
#include "core/read_file.h"
#include "tests/tools/scratch.h"
#include "tools/io/input_frame.h"
#include "tools/io/particle_sequence.h"
#include "tools/io/pysph_file.h"

namespace kappaflow {
namespace {

namespace fs = std::filesystem;

const fs::path kBlocks = KAPPAFLOW_SOURCE_DIR "/tests/data/pysph";

class PySph : public Scratch {};

TEST_F(PySph, HoldsTheLiquidWithItsTime) {
  for (const auto& [name, time] : {std::pair("block_0.hdf5", 0.0), {"block_100.hdf5", 0.1}}) {
    const InputFrame frame = read_input_frame(kBlocks / name);
    EXPECT_EQ(frame.time, time);
    EXPECT_EQ(frame.velocity_name, "u, v, w");
    ASSERT_EQ(frame.position.size(), 27u) << "none of the wall";
    const Vec3 velocity(0.5, 0.25, -0.125);
    for (std::size_t i = 0; i < 27; ++i) {
      const auto n = static_cast<double>(i);
      const Vec3 start = 0.1 * Vec3(std::floor(n / 9), std::floor(std::fmod(n / 3, 3)), std::fmod(n, 3));
      EXPECT_LT((frame.position[i] - (start + velocity * time)).norm(), 1e-12) << name << " " << i;
      EXPECT_EQ(frame.velocity[i], velocity);
      EXPECT_EQ(frame.id[i], 52 - 2 * static_cast<std::int64_t>(i));
      EXPECT_EQ(frame.density[i], 1000);
      EXPECT_EQ(frame.pressure[i], 5);
    }
  }
}

TEST_F(PySph, TheLastFrameNeedsNoEqualStep) {
  const ParticleSequence sequence(file_series(std::vector{(kBlocks / "block_*.hdf5").string()}), {});
  EXPECT_EQ(sequence.size(), 3u);
  EXPECT_TRUE(sequence.matched());
  EXPECT_EQ(sequence.time(2), 0.1875);
}

/// Files cut short anywhere, or with some bytes changed, are refused or read; HDF5 prints nothing.
TEST_F(PySph, SurvivesDamage) {
  testing::internal::CaptureStderr();
  std::mt19937 random(5);
  int refused = 0, read = 0;
  const auto try_bytes = [&](const std::string& bytes) {
    try {
      read_pysph(file("damaged.hdf5", bytes));
      ++read;
    } catch (const IoError& error) {
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
      ++refused;
    }
  };
  for (const char* name : {"block_0.hdf5", "block_100.hdf5"}) {
    const std::string whole = read_file(kBlocks / name);
    for (std::size_t size = 0; size < whole.size(); size += 997) try_bytes(whole.substr(0, size));
    for (int i = 0; i < 300; ++i) {
      std::string bytes = whole;
      for (std::size_t change = random() % 20; change > 0; --change) {
        std::size_t at = random() % bytes.size();
        while (bytes[at] == 0) at = (at + 1) % bytes.size();  // what is there, not what is between
        bytes[at] = static_cast<char>(random());
      }
      try_bytes(bytes);
    }
  }
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  EXPECT_GT(refused, 100);
  EXPECT_GT(read, 100);
}

}  // namespace
}  // namespace kappaflow
