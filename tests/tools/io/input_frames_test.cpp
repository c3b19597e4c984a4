// How often files are read: shown by taking them away in between.
#include "tools/io/input_frames.h"

#include "core/bytes.h"
#include "core/errors.h"
#include "tests/tools/scratch.h"
#include "tests/tools/sequence_files.h"
#include "tools/io/particle_sequence.h"

namespace kappaflow {
namespace {

class InputFramesOf : public Scratch {
 protected:
  static constexpr int kFrames = 6;

  void SetUp() override {
    Scratch::SetUp();
    for (int k = 0; k < kFrames; ++k)
      files.push_back(file(fmt::format("p_{}.csv", k), csv_text(moved_block({}, 0.1 * k), true, false)));
  }
  void take_files_away() const {
    for (const auto& file : files) std::filesystem::remove(file);
  }

  std::vector<std::filesystem::path> files;
};

TEST_F(InputFramesOf, SeriesThatFitsIsReadOnce) {
  ParticleSequence sequence(file_series(std::vector<std::string>{(folder / "p_*.csv").string()}), 10);
  take_files_away();
  for (int k = 0; k < kFrames; ++k) {
    const Particles expected = moved_block({}, 0.1 * k), found = sequence.frame(k).particles;
    EXPECT_EQ(found.id, expected.id) << "frame " << k;
    EXPECT_DOUBLE_EQ(found.time, 0.1 * k);
  }
}

TEST_F(InputFramesOf, BeyondTheLimitOnlyTheFirstAndTheLastReadStay) {
  FileSeries series;
  series.files = files;
  InputFrames all(series);
  const std::size_t bytes = bytes_of(all[0].position, all[0].id);
  InputFrames frames(series, 2 * bytes);
  for (int k = 0; k < kFrames; ++k) frames[k];
  take_files_away();
  for (const int k : {0, 1, 3, 4, 5}) EXPECT_EQ(frames[k].position.size(), all[0].position.size()) << k;
  EXPECT_THROW(frames[2], IoError);
}

TEST_F(InputFramesOf, AnErrorOfTheNextFrameIsTheNextFrames) {
  std::filesystem::remove(files[1]);
  FileSeries series;
  series.files = files;
  InputFrames frames(series);
  EXPECT_EQ(frames[0].position.size(), moved_block({}, 0).size());
  EXPECT_THROW(frames[1], IoError);
  EXPECT_EQ(frames[2].position.size(), frames[0].position.size());
}

}  // namespace
}  // namespace kappaflow
