// Sequences whose frames come in pieces, beside the same ones in a file a frame.
#include "core/errors.h"
#include "tests/tools/runs/track_case.h"

namespace kappaflow {
namespace {

namespace fs = std::filesystem;

constexpr int kRanks = 3;

class TrackPieces : public Track {
 protected:
  /// Each rank has the particles that are in its part of the block, which is another in each frame; a piece
  /// may have none.
  void write_pieces(const std::string& stem, bool ids, bool velocities) {
    for (int k = 0; k < kFrames; ++k) {
      const Particles whole = moved_block(kBodyMotion, 0.1 * k);
      Particles all;
      for (int rank = 0; rank < kRanks; ++rank) {
        Particles piece;
        for (std::size_t i = 0; i < whole.size(); ++i) {
          if ((i + 7 * static_cast<std::size_t>(k)) / 50 % kRanks != static_cast<std::size_t>(rank)) continue;
          for (Particles* part : {&piece, &all}) {
            part->id.push_back(whole.id[i]);
            part->position.push_back(whole.position[i]);
            part->velocity.push_back(whole.velocity[i]);
          }
        }
        file(fmt::format("{}_{}_rank{}.csv", stem, k, rank), csv_text(piece, ids, velocities));
      }
      file(fmt::format("{}whole_{}.csv", stem, k), csv_text(all, ids, velocities));
    }
  }
};

TEST_F(TrackPieces, GiveTheSameBitsAsOneFileAFrame) {
  struct Case {
    const char* stem;
    bool ids, velocities, backward;
  };
  for (const Case& c :
       {Case{"a", true, true, false}, Case{"b", true, false, true}, Case{"c", false, true, false}}) {
    write_pieces(c.stem, c.ids, c.velocities);
    const auto run = [&](const std::string& pattern, const char* out) {
      TrackOptions o = options(pattern, {"material", "regional"});
      o.folder = folder / out;
      o.range = {.first = 1, .backward = c.backward};
      return track(o);
    };
    ASSERT_EQ(run(fmt::format("{}_*.csv", c.stem), "pieces"), 0);
    ASSERT_EQ(run(fmt::format("{}whole_*.csv", c.stem), "whole"), 0);
    EXPECT_EQ(results_in(folder / "pieces"), results_in(folder / "whole"));
    for (const fs::path& name : results_in(folder / "pieces"))
      EXPECT_TRUE(bytes_of(folder / "pieces" / name) == bytes_of(folder / "whole" / name)) << c.stem << name;
  }
}

TEST_F(TrackPieces, OfImagesAreSaid) {
  for (const char* name : {"p_1_rank0.vti", "p_1_rank1.vti", "p_2_rank0.vti", "p_2_rank1.vti"})
    file(name, "");
  EXPECT_EQ(
      message_of<InvalidInput>([&] { track(options_for("p_*.vti", {})); }),
      (folder / "p_1_rank1.vti").string() + ": is a piece of a frame; images are read from one file a frame");
}

}  // namespace
}  // namespace kappaflow
