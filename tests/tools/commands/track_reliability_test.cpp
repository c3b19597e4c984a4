// What runs of `track` promise: stopped however often, they go on to the same bits.
#include <fmt/format.h>

#include <csignal>
#include <fstream>
#include <functional>

#include "tests/tools/commands/reliability.h"
#include "tests/tools/distance_files.h"
#include "tests/tools/sequence_files.h"
#include "tests/tools/vdb_writer.h"

namespace kappaflow {
namespace {

namespace fs = std::filesystem;

/// Another program's particles: a block that moves and turns, without times.
class TrackReliability : public Reliability {
 protected:
  static constexpr int kFrames = 30;

  void SetUp() override {
    Reliability::SetUp();
    fs::create_directory(folder / "in");
    for (int k = 0; k < kFrames; ++k)
      file(fmt::format("in/p_{}.csv", k), csv_text(moved_block(kBodyMotion, 0.1 * k), true, true));
  }
  std::vector<std::string> words_to_track(const fs::path& out) const {
    return {"track",      (folder / "in/p_*.csv").string(),
            "--out",      out.string(),
            "--fps",      "10",
            "--velocity", "material,regional",
            "--format",   "ply,usd"};
  }
  /// A run that was stopped after its first frame.
  fs::path stopped_track() const {
    const fs::path out = folder / "stopped";
    const ProgramResult result = run_program(words_to_track(out), {}, {SIGINT, out / "checkpoint.bin"});
    EXPECT_EQ(result.exit_code, 130) << result.err;
    EXPECT_TRUE(result.err.ends_with("; kappaflow track --resume " + out.string() + " goes on\n"))
        << result.err;
    return out;
  }
};

TEST_F(TrackReliability, StoppedRunsGoOnToTheSameBits) {
  const double whole = run_whole(words_to_track(folder / "whole"));
  std::mt19937 random(3);
  for (const int signal : {SIGKILL, SIGTERM}) {
    const fs::path out = folder / fmt::format("stopped by {}", signal);
    for (int stops = 0; stops == 0;) {
      fs::remove_all(out);
      stops = run_with_stops(words_to_track(out), out, signal, whole, random);
    }
    expect_same_results(folder / "whole", out);
  }
  const std::string complete = (folder / fmt::format("stopped by {}", SIGTERM)).string();
  const ProgramResult again = run_program({"track", "--resume", complete});
  EXPECT_EQ(again.exit_code, 0) << again.err;
  EXPECT_EQ(again.out, fmt::format("{}: the run is complete, {} frames\n", complete, kFrames));
}

TEST_F(TrackReliability, OtherParticlesAreNotResumed) {
  const fs::path out = stopped_track(), last = folder / fmt::format("in/p_{}.csv", kFrames - 1);
  const std::string text = bytes_of(last);
  Particles other = moved_block(kBodyMotion, 0.1 * (kFrames - 1));
  other.velocity.back().x() += 1e-6;
  std::ofstream(last) << csv_text(other, true, true);
  const ProgramResult changed = run_program({"track", "--resume", out.string()});
  EXPECT_EQ(changed.exit_code, 2);
  EXPECT_EQ(changed.err,
            "kappaflow: error: p: the files are not those that the run in " + out.string() + " began with\n");
  fs::remove(last);
  const ProgramResult missing = run_program({"track", "--resume", out.string()});
  EXPECT_EQ(missing.exit_code, 5);
  EXPECT_EQ(missing.err,
            "kappaflow: error: " + last.string() + ": cannot be read (No such file or directory)\n");
  std::ofstream(last) << text;
  const ProgramResult run = run_program({"run", "--resume", out.string()});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_EQ(run.err, "kappaflow: error: " + out.string() + ": kappaflow track --resume goes on with it\n");
}

TEST_F(TrackReliability, ParticlesMayHaveMoved) {
  run_whole(words_to_track(folder / "whole"));
  const fs::path out = stopped_track();
  fs::rename(folder / "in", folder / "moved");
  const ProgramResult result =
      run_program({"track", (folder / "moved/p_*.csv").string(), "--resume", out.string(), "--threads", "1"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(bytes_of(out / "run.json").find("\"resumed\""), std::string::npos);
  fs::remove(out / "checkpoint.bin");  // it names the files where they are now
  fs::remove(folder / "whole/checkpoint.bin");
  expect_same_results(folder / "whole", out);
}

/// n^3 points with distances and velocities, as raw bytes behind the XML: 16 bytes a point.
std::string raw_vti(int n) {
  const std::size_t points = static_cast<std::size_t>(n) * n * n;
  const auto bytes = [](std::size_t numbers) {
    const std::uint32_t size = static_cast<std::uint32_t>(4 * numbers);
    return std::string(reinterpret_cast<const char*>(&size), sizeof size) + std::string(size, '\0');
  };
  const std::string extent = fmt::format("0 {0} 0 {0} 0 {0}", n - 1);
  return fmt::format(
             "<VTKFile type=\"ImageData\" byte_order=\"LittleEndian\"><ImageData WholeExtent=\"{0}\">"
             "<FieldData><DataArray type=\"Float64\" Name=\"TimeValue\">0</DataArray></FieldData>"
             "<Piece Extent=\"{0}\"><PointData><DataArray type=\"Float32\" Name=\"phi\" format=\"appended\" "
             "offset=\"0\"/><DataArray type=\"Float32\" Name=\"u\" NumberOfComponents=\"3\" "
             "format=\"appended\" offset=\"{1}\"/></PointData></Piece></ImageData>"
             "<AppendedData encoding=\"raw\">_",
             extent, 4 + 4 * points) +
         bytes(points) + bytes(3 * points) + "</AppendedData></VTKFile>";
}

// Its bytes, and its numbers in double precision; 0.2 of that for whatever else.
TEST_F(Reliability, ReadingAnImageTakesThreeTimesItsFile) {
#if defined(__SANITIZE_THREAD__) || defined(__SANITIZE_ADDRESS__)
  GTEST_SKIP() << "the sanitizer holds memory of its own";
#endif
  const std::string image = raw_vti(128);
  for (const char* name : {"phi_0.vti", "phi_1.vti"}) file(name, image);
  const ProgramResult result = run_program({"track", folder.string()});
  ASSERT_NE(result.err.find("phi_1.vti: its time, 0 s, is not after"), std::string::npos) << result.err;
  const auto taken = static_cast<double>(result.peak_memory - run_program({"track", "--help"}).peak_memory);
  EXPECT_LT(taken, 1.2 * 3 * static_cast<double>(image.size()));
}

/// A sequence of one kind, with the options that it is tracked by.
struct SequenceKind {
  const char* name;
  std::function<bool(int k, const fs::path& stem)> write;  ///< false where it cannot be
  std::vector<std::string> options;
};

/// For the names of tests.
void PrintTo(const SequenceKind& kind, std::ostream* out) {
  *out << kind.name;
}

constexpr int kImages = 12;
constexpr double kImageInterval = 0.03;  // [s]

bool write_text(const fs::path& file, const std::string& text) {
  std::ofstream(file, std::ios::binary) << text;
  return true;
}
double image_time(int k) {
  return kImageInterval * k;
}
fs::path with_ending(const fs::path& stem, const char* ending) {
  return stem.string() + ending;
}
bool write_vti(int k, const fs::path& stem, bool velocities) {
  return write_text(with_ending(stem, ".vti"),
                    vti_of(image_of_box(image_time(k), velocities), image_time(k)));
}

const std::vector<SequenceKind> kSequenceKinds{
    {"vti",
     [](int k, const fs::path& stem) { return write_vti(k, stem, false); },
     {"--velocity", "regional"}},
    {"vtiWithVelocities",
     [](int k, const fs::path& stem) { return write_vti(k, stem, true); },
     {"--velocity", "material,fresh-grid", "--metrics", "3"}},
    {"vtiBackward",
     [](int k, const fs::path& stem) { return write_vti(k, stem, true); },
     {"--velocity", "material,regional", "--frames", "0:10:1", "--backward"}},
    {"vtk",
     [](int k, const fs::path& stem) {
       return write_text(with_ending(stem, ".vtk"), vtk_of(image_of_box(image_time(k), true), image_time(k)));
     },
     {"--rest-interval", "2"}},
    {"vdb",
     [](int k, const fs::path& stem) {
       return write_vdb(with_ending(stem, ".vdb"), frame_of_box(image_time(k)));
     },
     {}},
    {"particlesWithAnisotropicKernels",
     [](int k, const fs::path& stem) {
       return write_text(with_ending(stem, ".csv"),
                         csv_text(moved_block(kBodyMotion, image_time(k)), true, true));
     },
     {"--fps", "33.3", "--kernels", "anisotropic", "--velocity", "material,regional"}},
    {"particlesInPieces",
     [](int k, const fs::path& stem) {
       const Particles block = moved_block(kBodyMotion, image_time(k));
       bool written = true;
       for (std::size_t rank = 0; rank < 3; ++rank) {
         Particles piece;
         for (std::size_t i = rank; i < block.size(); i += 3) {
           piece.id.push_back(block.id[i]);
           piece.position.push_back(block.position[i]);
           piece.velocity.push_back(block.velocity[i]);
         }
         written = written &&
                   write_text(fmt::format("{}_rank{}.csv", stem.string(), rank), csv_text(piece, true, true));
       }
       return written;
     },
     {"--fps", "33.3", "--velocity", "material,regional"}},
    {"obj",
     [](int k, const fs::path& stem) {
       return write_text(with_ending(stem, ".obj"), obj_of_box(image_time(k), 0.06));
     },
     {"--fps", "33.3", "--backward"}},
};

class StoppedSequence : public Reliability, public ::testing::WithParamInterface<SequenceKind> {};

TEST_P(StoppedSequence, GoesOnToTheSameBits) {
  fs::create_directory(folder / "in");
  for (int k = 0; k < kImages; ++k)
    if (!GetParam().write(k, folder / fmt::format("in/phi_{}", k))) GTEST_SKIP() << "built without OpenVDB";
  const auto words = [&](const fs::path& out) {
    std::vector<std::string> all{"track", (folder / "in").string(), "--out", out.string()};
    all.insert(all.end(), GetParam().options.begin(), GetParam().options.end());
    return all;
  };
  run_whole(words(folder / "whole"));
  const fs::path out = folder / "stopped", first = out / "checkpoint.bin";
  ASSERT_EQ(run_program(words(out), {}, {SIGTERM, first}).exit_code, 143);
  const ProgramResult resumed = run_program({"track", "--resume", out.string()});
  ASSERT_EQ(resumed.exit_code, 0) << resumed.err;
  expect_same_results(folder / "whole", out);
}

INSTANTIATE_TEST_SUITE_P(OfEveryKind, StoppedSequence, ::testing::ValuesIn(kSequenceKinds),
                         [](const auto& kind) { return std::string(kind.param.name); });

}  // namespace
}  // namespace kappaflow
