// Images of distances that lie in several files, beside the same ones in one.
#include "tools/io/image_pieces.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <random>

#include "core/errors.h"
#include "tests/tools/scratch.h"
#include "tools/io/input_kind.h"
#include "tools/io/lattice_box.h"

namespace kappaflow {
namespace {

namespace fs = std::filesystem;

const Vec3 kOrigin(0.1, -0.7, 1e-3), kSpacing(0.1, 0.3, 0.7);

std::string extent_text(const LatticeBox& box) {
  return fmt::format("{} {} {} {} {} {}", box.first[0], box.last[0], box.first[1], box.last[1], box.first[2],
                     box.last[2]);
}

std::string lattice_text(const Vec3& origin, const Vec3& spacing) {
  return fmt::format("Origin=\"{}\" Spacing=\"{}\"", fmt::join(origin, " "), fmt::join(spacing, " "));
}

/// A number that no other point has, and none other of its components.
float number_of(std::int64_t i, std::int64_t j, std::int64_t k, int component) {
  return static_cast<float>(0.1 * static_cast<double>(i + 37 * j + 1301 * k) + 1e4 * component);
}

/// What a solver might write of a part of its lattice.
struct WrittenImage {
  LatticeBox points{};
  LatticeBox own{};       // of these points, or cells; others have a mark, and a number that must not be used
  bool of_cells = false;  // else of points
  bool velocities = true;
  double time = 0.5;
  Vec3 origin = kOrigin;
  std::int64_t shift = 0;  // of the file's numbers

  std::string array(
      const char* type, const char* name, int components,
      const std::function<std::string(std::int64_t, std::int64_t, std::int64_t, int)>& text) const {
    std::string numbers;
    const int less = of_cells ? 1 : 0;
    for (std::int64_t k = points.first[2]; k <= points.last[2] - less; ++k)
      for (std::int64_t j = points.first[1]; j <= points.last[1] - less; ++j)
        for (std::int64_t i = points.first[0]; i <= points.last[0] - less; ++i)
          for (int c = 0; c < components; ++c) numbers += text(i, j, k, c) + " ";
    return fmt::format(
        "<DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" format=\"ascii\">{}</DataArray>", type,
        name, components, numbers);
  }
  std::string text() const {
    const auto is_own = [this](std::int64_t i, std::int64_t j, std::int64_t k) {
      return own.contains({{i, j, k}, {i, j, k}});
    };
    const auto number = [&](std::int64_t i, std::int64_t j, std::int64_t k, int c) {
      return is_own(i, j, k) ? fmt::format("{}", number_of(i, j, k, c)) : std::string("nan");
    };
    const auto mark = [&](std::int64_t i, std::int64_t j, std::int64_t k, int) {
      return std::string(is_own(i, j, k) ? "0" : "1");
    };
    std::string arrays = array("Float32", "phi", 1, number);
    if (velocities) arrays += array("Float32", "velocity", 3, number);
    arrays += array("UInt8", "vtkGhostType", 1, mark);
    LatticeBox numbered = points;
    for (std::size_t c = 0; c < 3; ++c) numbered.first[c] += shift, numbered.last[c] += shift;
    const char* const kind = of_cells ? "CellData" : "PointData";
    return fmt::format(
        "<VTKFile type=\"ImageData\"><ImageData WholeExtent=\"{0}\" {1}><FieldData><DataArray "
        "type=\"Float64\" Name=\"TimeValue\" format=\"ascii\">{2}</DataArray></FieldData>"
        "<Piece Extent=\"{0}\"><{3}>{4}</{3}></Piece></ImageData></VTKFile>",
        extent_text(numbered), lattice_text(origin, kSpacing), time, kind, arrays);
  }
};

/// Without ghosts.
WrittenImage written(const LatticeBox& points, bool of_cells = false) {
  return {.points = points, .own = points, .of_cells = of_cells};
}

struct Listed {
  LatticeBox extent;
  std::string source;
};

std::string list_text(const LatticeBox& whole, const std::vector<Listed>& pieces) {
  std::string text;
  for (const Listed& piece : pieces)
    text += fmt::format("<Piece Extent=\"{}\" Source=\"{}\"/>", extent_text(piece.extent), piece.source);
  return fmt::format(
      "<VTKFile type=\"PImageData\"><PImageData WholeExtent=\"{}\" {}>{}</PImageData></VTKFile>",
      extent_text(whole), lattice_text(kOrigin, kSpacing), text);
}

void expect_same(const ImageFrame& a, const ImageFrame& b) {
  EXPECT_EQ(a.dims, b.dims);
  EXPECT_EQ(a.origin, b.origin);
  EXPECT_EQ(a.spacing, b.spacing);
  EXPECT_TRUE(a.value == b.value);
  EXPECT_TRUE(a.velocity == b.velocity);
  EXPECT_EQ(a.time, b.time);
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.velocity_name, b.velocity_name);
}

/// From least to most, both included.
std::int64_t random_between(std::mt19937& random, std::int64_t least, std::int64_t most) {
  return least + static_cast<std::int64_t>(random() % static_cast<unsigned>(most - least + 1));
}

/// Cuts a box again and again where chance has it; of the halves that share points each has the cut.
void cut_at_random(const LatticeBox& box, int times, bool share, std::mt19937& random,
                   std::vector<LatticeBox>& parts) {
  const auto c = static_cast<std::size_t>(random() % 3);
  if (times == 0 || box.last[c] - box.first[c] < 3) {
    parts.push_back(box);
    return;
  }
  LatticeBox low = box, high = box;
  high.first[c] = random_between(random, box.first[c] + 1, box.last[c] - 1);
  low.last[c] = high.first[c] - (share ? 0 : 1);
  cut_at_random(high, times - 1, share, random, parts);
  cut_at_random(low, times - 1, share, random, parts);
}

LatticeBox grown(LatticeBox box, std::int64_t by) {
  for (std::size_t c = 0; c < 3; ++c) box.first[c] -= by, box.last[c] += by;
  return box;
}

class ImagePieces : public Scratch {
 protected:
  static constexpr LatticeBox kWhole{{-2, 0, 3}, {9, 7, 9}};
  static constexpr LatticeBox kLow{{-2, 0, 3}, {4, 7, 9}}, kHigh{{4, 0, 3}, {9, 7, 9}};

  std::string path(const std::string& name) const { return (folder / name).string(); }
  fs::path write(const std::string& name, const WrittenImage& image) const {
    return file(name, image.text());
  }
  fs::path list(const std::vector<Listed>& pieces) const { return file("a.pvti", list_text(kWhole, pieces)); }
  /// Of both halves, of which the second is as given.
  std::string failure(const WrittenImage& high) const {
    write("low.vti", written(kLow));
    write("high.vti", high);
    const fs::path file = list({{kLow, "low.vti"}, {kHigh, "high.vti"}});
    return message_of<InvalidInput>([&] { read_image(file); });
  }
};

// Pieces cut at random, with ghosts around them that are wrong, some of which are beyond the whole.
TEST_F(ImagePieces, GiveTheSameBitsAsOneFile) {
  std::mt19937 random(7);
  for (int round = 0; round < 30; ++round) {
    const bool of_cells = round % 3 == 0, share = of_cells || round % 2 == 0;
    std::vector<LatticeBox> parts;
    cut_at_random(kWhole, 1 + round % 4, share, random, parts);
    std::vector<Listed> pieces;
    std::vector<fs::path> ranks, local;
    for (const LatticeBox& part : parts) {
      WrittenImage piece = written(part, of_cells);
      if (of_cells)
        for (std::int64_t& last : piece.own.last) --last;
      piece.points = grown(part, round % 5 % 3);
      const std::string name = fmt::format("p_{}.vti", pieces.size());
      write(name, piece);
      pieces.push_back({round % 7 == 0 ? piece.points : part, name});
      piece.points = grown(part, round % 5 % 3).common_with(kWhole);
      ranks.push_back(write("r" + name, piece));
      // The same with the numbers of its own that begin elsewhere.
      piece.shift = round;
      piece.origin -= static_cast<double>(round) * kSpacing;
      local.push_back(write("l" + name, piece));
    }
    WrittenImage whole = written(kWhole, of_cells);
    const ImageFrame expected = read_image(write("whole.vti", whole));
    ASSERT_EQ(expected.value[1], number_of(-1, 0, 3, 0));
    expect_same(read_image(list(pieces)), expected);
    expect_same(read_image(ranks), expected);
    const ImageFrame of_local = read_image(local);
    EXPECT_TRUE(of_local.value == expected.value && of_local.velocity == expected.velocity);
    EXPECT_LT((of_local.origin - expected.origin).norm(), 1e-12);
  }
}

TEST_F(ImagePieces, OfVtksParallelWriterAreReadWithTheirGhosts) {
  const ImageFrame frame = read_image(fs::path(KAPPAFLOW_SOURCE_DIR "/tests/data/pieces/image.pvti"));
  EXPECT_EQ(frame.dims, (std::array{10, 6, 5}));
  EXPECT_EQ(frame.origin, Vec3(1, 2, 3));
  EXPECT_EQ(frame.spacing, Vec3(0.5, 0.25, 0.125));
  EXPECT_EQ(frame.time, 0.75);
  for (std::size_t p = 0; p < 300; ++p)
    ASSERT_EQ(frame.value[p], static_cast<float>(p % 10 + 10 * (p / 10 % 6) + 100 * (p / 60))) << p;
}

TEST_F(ImagePieces, MayLieInOtherFoldersAndBeNamedAsWindowsDoes) {
  fs::create_directories(folder / "parts/of");
  write("parts/of/low.vti", written(kLow));
  write("parts/high.vti", written(kHigh));
  const ImageFrame whole = read_image(write("whole.vti", written(kWhole)));
  for (const char* const low : {"parts/of/low.vti", "parts\\of\\low.vti"})
    expect_same(read_image(list({{kLow, low}, {kHigh, path("parts/high.vti")}})), whole);
}

TEST_F(ImagePieces, MayLeaveTheTimeToTheList) {
  std::string text = written(kWhole).text();
  const std::size_t begin = text.find("<FieldData>"), end = text.find("<Piece ");
  file("whole.vti", text.erase(begin, end - begin));
  text = list_text(kWhole, {{kWhole, "whole.vti"}});
  const std::string time = "<FieldData><DataArray type=\"Float64\" Name=\"time\">2.5</DataArray></FieldData>";
  EXPECT_EQ(read_image(file("a.pvti", text)).time, std::nullopt);
  EXPECT_EQ(read_image(file("a.pvti", text.insert(text.find("<Piece "), time))).time, 2.5);
}

TEST_F(ImagePieces, ThatLeaveAGapAreSaid) {
  LatticeBox beyond = kHigh;
  beyond.first[0] = 6;
  const fs::path low = write("low.vti", written(kLow)), high = write("high.vti", written(beyond));
  EXPECT_EQ(
      message_of<InvalidInput>([&] {
        read_image(list({{kLow, "low.vti"}, {beyond, "high.vti"}}));
      }),
      path("a.pvti") +
          ": the pieces of this frame leave a gap: none has the points (5, 0, 3) to (5, 7, 9); expected "
          "all from (-2, 0, 3) to (9, 7, 9)");
  EXPECT_EQ(
      message_of<InvalidInput>([&] {
        read_image(list({{kLow, "low.vti"}}));
      }),
      path("a.pvti") +
          ": the pieces of this frame leave a gap: none has the points (5, 0, 3) to (9, 7, 9); expected "
          "all from (-2, 0, 3) to (9, 7, 9)");
  EXPECT_EQ(message_of<InvalidInput>([&] {
              read_image(std::vector{high, low});
            }),
            path("high.vti") +
                ": the pieces of this frame leave a gap: none has the points (7, 0, 0) to (7, 7, 6); "
                "expected all from (0, 0, 0) to (11, 7, 6)");
  write("low.vti", written(kLow, true));
  beyond.first[0] = 5;
  write("high.vti", written(beyond, true));
  EXPECT_EQ(message_of<InvalidInput>([&] {
              read_image(list({{kLow, "low.vti"}, {beyond, "high.vti"}}));
            }),
            path("a.pvti") +
                ": the pieces of this frame leave a gap: none has the cells (4, 0, 3) to (4, 6, 8); expected "
                "all from (-2, 0, 3) to (8, 6, 8)");
}

TEST_F(ImagePieces, ThatAreNotThereOrCutOffAreSaid) {
  const std::string low = written(kLow).text();
  file("low.vti", low.substr(0, low.size() / 2));
  write("high.vti", written(kHigh));
  EXPECT_EQ(message_of<IoError>([&] {
              read_image(list({{kHigh, "high.vti"}, {kLow, "none.vti"}}));
            }),
            path("a.pvti") + ": its piece " + path("none.vti") + " is not there");
  EXPECT_EQ(message_of<IoError>([&] {
              read_image(list({{kHigh, "high.vti"}, {kLow, "low.vtp"}}));
            }),
            path("a.pvti") + ": its piece low.vtp is no .vti");
  const std::string begin = path("low.vti") + ": is damaged or not complete (";
  EXPECT_TRUE(message_of<IoError>([&] {
                read_image(list({{kHigh, "high.vti"}, {kLow, "low.vti"}}));
              }).starts_with(begin));
  EXPECT_TRUE(message_of<IoError>([&] {
                read_image(std::vector{folder / "high.vti", folder / "low.vti"});
              }).starts_with(begin));
}

TEST_F(ImagePieces, ThatDoNotFitAreSaid) {
  const std::string beside = path("low.vti") + ", a piece of the same frame, ";
  WrittenImage high = written(kHigh);
  high.time = 0.25;
  EXPECT_EQ(failure(high), path("high.vti") + ": its time is 0.25 s; that of " + beside + "is 0.5 s");
  high = written(kHigh);
  high.velocities = false;
  EXPECT_EQ(failure(high), path("high.vti") + ": has no velocities; " + beside + "has");
  EXPECT_EQ(failure(written(kHigh, true)), path("high.vti") +
                                               ": its distances are \"phi\" of cells; those of " + beside +
                                               "are \"phi\" of points");
  high = written(kHigh);
  high.points.first[0] = 5;
  EXPECT_EQ(failure(high), path("high.vti") +
                               ": has the points (5, 0, 3) to (9, 7, 9); expected (4, 0, 3) to "
                               "(9, 7, 9), as " +
                               path("a.pvti") + " says");
  high = written(kHigh);
  high.origin.y() += 0.01;
  EXPECT_EQ(failure(high),
            path("high.vti") +
                ": its values begin at (0.5, -0.69, 2.101), (0.1, 0.3, 0.7) apart; expected them "
                "on the lattice of " +
                path("a.pvti") + ", with values at (0.1, -0.7, 0.001), (0.1, 0.3, 0.7) apart");
  high = written(kHigh);
  high.own.last[0] = 8;  // the last plane has no numbers
  std::string text = high.text();
  for (std::size_t at = 0; (at = text.find(" 1 ", at)) != std::string::npos;) text[at + 1] = '0';
  file("high.vti", text);
  EXPECT_EQ(message_of<InvalidInput>([&] { read_image(folder / "a.pvti"); }),
            path("high.vti") + ": \"phi\" of point (5, 0, 0) is nan; it must be finite");
}

TEST_F(ImagePieces, OfAListThatIsWrongAreSaid) {
  write("low.vti", written(kLow));
  const auto changed = [&](const std::string& from, const std::string& to) {
    std::string text = list_text(kWhole, {{kLow, "low.vti"}});
    return file("a.pvti", text.replace(text.find(from), from.size(), to));
  };
  const auto failure_of = [&](const fs::path& list) {
    return message_of<Error>([&] { read_image(list); }).substr(path("a.pvti: ").size());
  };
  const std::string damaged = "is damaged or not complete (";
  EXPECT_EQ(failure_of(list({})), damaged + "has no pieces)");
  EXPECT_EQ(failure_of(changed("low.vti", "")), damaged + "has a piece without a Source)");
  EXPECT_EQ(failure_of(changed("<Piece Extent", "<Piece Extend")),
            damaged + "Extent is \"\"; expected the first and last of points along x, y, z)");
  EXPECT_EQ(failure_of(changed("PImageData\"", "ImageData\"")),
            damaged + "holds \"ImageData\"; expected PImageData)");
  EXPECT_EQ(failure_of(changed("0.1 0.3 0.7", "0.1 0 0.7")),
            "its origin is (0.1, -0.7, 0.001), its spacing (0.1, 0, 0.7); expected finite numbers, and a "
            "spacing above 0");
  EXPECT_EQ(failure_of(changed("Spacing", "Direction=\"0 1 0 1 0 0 0 0 1\" Spacing")),
            "has a direction matrix; expected rows along x, y and z");
  EXPECT_NE(failure_of(changed("-2 9 0 7", "-2 99999 0 999999")).find("leave a gap"), std::string::npos)
      << "before there is memory for it";
}

TEST_F(ImagePieces, AreImages) {
  write("low.vti", written(kLow));
  const fs::path listed = list({{kLow, "low.vti"}});
  EXPECT_EQ(input_kind(std::vector{listed}), InputKind::images);
  EXPECT_EQ(input_kind(std::vector{folder / "low.vti", folder / "low.vti"}), InputKind::images);
  EXPECT_EQ(message_of<InvalidInput>([&] {
              input_kind(std::vector{fs::path("a.vdb"), fs::path("b.vdb")});
            }),
            "a.vdb: is a piece of a frame; .vdb files are read from one file a frame");
  EXPECT_EQ(message_of<InvalidInput>([&] {
              input_kind(std::vector{fs::path("a.csv"), folder / "low.vti"});
            }),
            path("low.vti") + ": holds images; a.csv, a piece of the same frame, holds particles");
}

// Point by point.
TEST(LatticeBoxes, LeaveTheGapsThatTheyLeave) {
  constexpr LatticeBox kBox{{-1, 0, 2}, {4, 4, 6}};
  std::mt19937 random(3);
  int filled = 0;
  for (int round = 0; round < 500; ++round) {
    std::vector<LatticeBox> parts;
    for (int p = 0; p < 7; ++p) {
      LatticeBox& part = parts.emplace_back();
      for (std::size_t c = 0; c < 3; ++c) {
        part.first[c] = random_between(random, kBox.first[c] - 1, kBox.first[c] + 1);
        part.last[c] = random_between(random, kBox.last[c] - 2, kBox.last[c] + 1);
      }
    }
    const auto is_in_a_part = [&](std::int64_t i, std::int64_t j, std::int64_t k) {
      return std::ranges::any_of(parts, [&](const LatticeBox& part) {
        return part.contains({{i, j, k}, {i, j, k}});
      });
    };
    const auto gap = gap_between(kBox, parts);
    bool all = true;
    for (std::int64_t k = kBox.first[2]; k <= kBox.last[2]; ++k)
      for (std::int64_t j = kBox.first[1]; j <= kBox.last[1]; ++j)
        for (std::int64_t i = kBox.first[0]; i <= kBox.last[0]; ++i) {
          all = all && is_in_a_part(i, j, k);
          EXPECT_FALSE(gap && gap->contains({{i, j, k}, {i, j, k}}) && is_in_a_part(i, j, k));
        }
    EXPECT_EQ(all, !gap.has_value());
    EXPECT_TRUE(!gap || (!gap->empty() && kBox.contains(*gap)));
    filled += all;
  }
  EXPECT_GT(filled, 50);
  EXPECT_LT(filled, 450);
}

}  // namespace
}  // namespace kappaflow
