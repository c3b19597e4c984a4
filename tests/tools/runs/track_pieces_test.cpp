// Sequences whose frames come in pieces, beside the same ones in a file a frame.
#include <algorithm>

#include "core/errors.h"
#include "tests/tools/distance_files.h"
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

/// Of an image the part that has these planes of points along x, with the same numbers as the whole.
std::string part_of_vti(const SignedDistances& image, double time, int first, int last) {
  SignedDistances part{.grid = image.grid, .value = {}};
  part.grid.dims[0] = last - first + 1;
  for (int k = 0; k < image.grid.dims[2]; ++k)
    for (int j = 0; j < image.grid.dims[1]; ++j)
      for (int i = first; i <= last; ++i) {
        part.value.push_back(image.value[image.grid.index(i, j, k)]);
        part.velocity.push_back(image.velocity[image.grid.index(i, j, k)]);
      }
  const auto extent = [&](int begin, int end) {
    return fmt::format("Extent=\"{} {} 0 {} 0 {}\"", begin, end, image.grid.dims[1] - 1,
                       image.grid.dims[2] - 1);
  };
  std::string text = vti_of(part, time);
  const std::string old_extent = extent(0, last - first), new_extent = extent(first, last);
  for (std::size_t at = 0; (at = text.find(old_extent, at)) != std::string::npos; ++at)
    text.replace(at, old_extent.size(), new_extent);
  return text;
}

// Slabs that share points at their borders, or have a layer of ghosts that the list leaves out.
TEST_F(TrackPieces, OfImagesGiveTheSameBitsAsOneFileAFrame) {
  constexpr int kEnds[] = {0, 9, 17, 27};
  for (int k = 0; k < 4; ++k) {
    const double time = 0.04 * k;
    const SignedDistances image = image_of_box(time, true);
    file(fmt::format("whole_{}.vti", k), vti_of(image, time));
    fs::create_directory(folder / fmt::format("parts_{}", k));
    std::string pieces;
    for (int rank = 0; rank < kRanks; ++rank) {
      const int first = kEnds[rank], last = kEnds[rank + 1];
      file(fmt::format("p_{}_rank{}.vti", k, rank), part_of_vti(image, time, first, last));
      file(fmt::format("parts_{}/{}.vti", k, rank),
           part_of_vti(image, time, std::max(first - 1, 0), std::min(last + 1, 27)));
      pieces +=
          fmt::format("<Piece Extent=\"{} {} 0 27 0 19\" Source=\"parts_{}/{}.vti\"/>", first, last, k, rank);
    }
    file(fmt::format("list_{}.pvti", k),
         fmt::format("<VTKFile type=\"PImageData\"><PImageData WholeExtent=\"0 27 0 27 0 19\" Origin=\"-0.65 "
                     "-0.65 -0.45\" Spacing=\"0.05 0.05 0.05\">{}</PImageData></VTKFile>",
                     pieces));
  }
  const auto run = [&](const char* pattern, const char* out) {
    TrackOptions o = options_for(pattern, {"material", "regional"});
    o.folder = folder / out;
    return track(o);
  };
  ASSERT_EQ(run("whole_*.vti", "whole"), 0);
  ASSERT_EQ(run("p_*.vti", "ranks"), 0);
  ASSERT_EQ(run("list_*.pvti", "list"), 0);
  for (const char* const out : {"ranks", "list"}) {
    EXPECT_EQ(results_in(folder / out), results_in(folder / "whole"));
    for (const fs::path& name : results_in(folder / out))
      EXPECT_TRUE(bytes_of(folder / out / name) == bytes_of(folder / "whole" / name)) << out << name;
  }
}

TEST_F(TrackPieces, OfMeshesAreSaid) {
  for (const char* name : {"p_1_rank0.obj", "p_1_rank1.obj", "p_2_rank0.obj", "p_2_rank1.obj"})
    file(name, "");
  EXPECT_EQ(
      message_of<InvalidInput>([&] { track(options_for("p_*.obj", {})); }),
      (folder / "p_1_rank0.obj").string() + ": is a piece of a frame; meshes are read from one file a frame");
}

}  // namespace
}  // namespace kappaflow
