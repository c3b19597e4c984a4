// Sequences tracked from their last frame to their first.
#include <functional>

#include "core/errors.h"
#include "tests/tools/distance_files.h"
#include "tests/tools/runs/track_case.h"
#include "tests/tools/text_table.h"

namespace kappaflow {
namespace {

namespace fs = std::filesystem;

constexpr double kInterval = 0.0625;  // [s]; times that are sums and differences of it have no rounding
constexpr double kLast = kInterval * (kFrames - 1);

class TrackBackward : public Track {
 protected:
  TrackOptions backward(const std::string& pattern, std::vector<std::string> methods) const {
    TrackOptions o = options(pattern, std::move(methods));
    o.frames_per_second = 1 / kInterval;
    o.range.backward = true;
    return o;
  }
  TrackOptions backward_images(const std::string& pattern, std::vector<std::string> methods) const {
    TrackOptions o = options_for(pattern, std::move(methods));
    o.frames_per_second = 1 / kInterval;
    o.range.backward = true;
    return o;
  }
  /// Of the last frame.
  template <class Moved>
  double end_error(const std::string& method, const Moved& moved) const {
    return mean_error(method, kFrames - 1, moved);
  }
};

Vec3 box_at_end(const Vec3& x) {
  return TurningBox::position(x, kLast);
}
/// Where the material was at 0 s that is at x in the last frame.
Vec3 box_at_start(const Vec3& x) {
  return Eigen::AngleAxisd(-TurningBox::kSpin * kLast, Vec3::UnitZ()) * (x - TurningBox::centre(kLast));
}
Vec3 block_at_start(const Vec3& x) {
  return kBodyMotion.rotation(kLast).transpose() * (x - kLast * kBodyMotion.velocity);
}

Particles reversed(Particles p) {
  for (Vec3& velocity : p.velocity) velocity = -velocity;
  return p;
}
SignedDistances reversed(SignedDistances image) {
  for (Eigen::Vector3f& velocity : image.velocity) velocity = -velocity;
  return image;
}

// By definition: what a program would have written whose time runs the other way.
TEST_F(TrackBackward, IsForwardThroughTheMirroredFiles) {
  struct Case {
    const char* ending;
    std::function<std::string(int, bool mirrored)> text;
  };
  const auto particles = [](int k, bool mirrored) {
    const Particles body = moved_block(kBodyMotion, kInterval * k);
    return mirrored ? reversed(body) : body;
  };
  const auto image = [](int k, bool mirrored) {
    const SignedDistances distances = image_of_box(kInterval * k, true);
    return vti_of(mirrored ? reversed(distances) : distances,
                  mirrored ? kInterval * (kFrames - 1 - k) : 3 + kInterval * k);
  };
  const std::vector<Case> cases{
      {"csv", [&](int k, bool mirrored) { return csv_text(particles(k, mirrored), true, true); }},
      {"est.csv", [&](int k, bool mirrored) { return csv_text(particles(k, mirrored), true, false); }},
      {"noid.csv", [&](int k, bool mirrored) { return csv_text(particles(k, mirrored), false, true); }},
      {"vti", image}};
  for (const Case& c : cases) {
    for (int k = 0; k < kFrames; ++k) {
      file(fmt::format("p_{}.{}", k + 6, c.ending), c.text(k, false));
      file(fmt::format("q_{}.{}", k + 6, c.ending), c.text(kFrames - 1 - k, true));
    }
    const bool images = std::string(c.ending) == "vti";
    const auto run = [&](const std::string& prefix, bool is_backward) {
      const std::string pattern = fmt::format("{}_*[0-9].{}", prefix, c.ending);
      TrackOptions o = images ? backward_images(pattern, {"material", "normal"})
                              : backward(pattern, {"material", "normal"});
      o.range.backward = is_backward;
      o.folder = folder / prefix;
      return track(o);
    };
    ASSERT_EQ(run("p", true), 0) << c.ending;
    ASSERT_EQ(run("q", false), 0) << c.ending;
    EXPECT_EQ(results_in(folder / "p"), results_in(folder / "q"));
    for (const fs::path& name : results_in(folder / "p"))
      EXPECT_TRUE(bytes_of(folder / "p" / name) == bytes_of(folder / "q" / name)) << c.ending << name;
  }
}

TEST_F(TrackBackward, ParticlesTakeTheirSurfaceToWhereTheyWere) {
  write_sequence("csv", kBodyMotion, kInterval,
                 [](const Particles& p, int k) { return csv_text(permuted(p, k), true, true); });
  ASSERT_EQ(track(backward("p_*.csv", {"material", "fresh-particles"})), 0);
  for (const char* method : {"material", "fresh-particles"}) {
    EXPECT_LT(end_error(method, block_at_start), 0.01 * kSigma) << method;
    EXPECT_GT(end_error(method, [](const Vec3& x) { return x; }), kSigma) << "it has moved";
  }
  const auto rows = read_table(folder / "out/metrics.csv");
  EXPECT_EQ(rows.front().at("time"), "0");
  EXPECT_DOUBLE_EQ(std::stod(rows.back().at("time")), kLast);
  EXPECT_LT(std::stod(rows[rows.size() - 2].at("slip")), 1e-6) << "velocities change their sign too";
  const auto last = read_vtp(folder / fmt::format("out/particles/particles_{:04}.vtp", kFrames - 1));
  const std::vector<Vec3> start = jittered_block();
  for (std::size_t i = 0; i < start.size(); ++i)
    EXPECT_LT((Vec3(last->GetPoint(static_cast<vtkIdType>(i))) - start[i]).norm(), 1e-6);
}

TEST_F(TrackBackward, ImagesAreFollowedAsWellAsForward) {
  for (const bool velocities : {false, true}) {
    for (int k = 0; k < kFrames; ++k)
      file(fmt::format("phi_{}.vti", k + 6),
           vti_of(image_of_box(kInterval * k, velocities), 3 + kInterval * k));
    const std::string method = velocities ? "material" : "regional";
    TrackOptions o = backward_images("phi_*.vti", {method});
    ASSERT_EQ(track(o), 0);
    const double there = end_error(method, box_at_start);
    EXPECT_EQ(read_table(folder / "out/metrics.csv").front().at("time"), "0");
    o.range.backward = false;
    ASSERT_EQ(track(o), 0);
    const double forward = end_error(method, box_at_end);
    EXPECT_LT(there, velocities ? 0.0005 : 0.01) << method;
    EXPECT_LT(there, 1.5 * forward) << method;
    EXPECT_EQ(read_table(folder / "out/metrics.csv").front().at("time"), "3") << "that of the files";
  }
}

TEST_F(TrackBackward, MeshesAreFollowedToTheirBeginning) {
  for (int k = 0; k < kFrames; ++k) file(fmt::format("m{}.obj", k), obj_of_box(kInterval * k, 0.04));
  ASSERT_EQ(track(backward_images("m*.obj", {"regional", "normal"})), 0);
  EXPECT_LT(end_error("regional", box_at_start), 0.01);
  EXPECT_GT(end_error("normal", box_at_start), 3 * end_error("regional", box_at_start));
}

TEST_F(TrackBackward, TheRecordSaysIt) {
  for (int k = 0; k < 4; ++k)
    file(fmt::format("phi_{}.vti", k), vti_of(image_of_box(kInterval * k, false), 3 + kInterval * k));
  TrackOptions o = backward_images("phi_*.vti", {});
  o.range = {0, 2, 1, true};
  ASSERT_EQ(track(o), 0);
  const std::string record = bytes_of(folder / "out/run.json"), first = (folder / "phi_2.vti").string();
  for (const std::string& text :
       {std::string("\"backward\" : true"), fmt::format("\"first\" : \"{}\"", first),
        fmt::format("\"backward from {}, which is at 3.125 s\"", first),
        std::string("\"times 0 to 0.125 s, from the files\""), std::string("\"duration\" : 0.125")})
    EXPECT_NE(record.find(text), std::string::npos) << text << "\n" << record;
  o.range.backward = false;
  ASSERT_EQ(track(o), 0);
  EXPECT_NE(bytes_of(folder / "out/run.json").find("\"backward\" : false"), std::string::npos);
}

TEST_F(TrackBackward, ErrorsNameTheFileThatTheyAreOf) {
  const auto refused = [&] {
    return message_of<InvalidInput>([&] { track(backward_images("phi_*.vti", {})); });
  };
  const auto path = [&](int k) { return (folder / fmt::format("phi_{}.vti", k)).string(); };
  const std::array<double, 3> times{0, 0.25, 0.25};
  for (int k = 0; k < 3; ++k) file(fmt::format("phi_{}.vti", k), vti_of(image_of_box(0, false), times[k]));
  EXPECT_EQ(refused(), path(2) + ": its time, 0.25 s, is not after that of the file before, 0.25 s");
  file("phi_1.vti", vti_of(image_of_box(0, true), 0.125));
  EXPECT_EQ(refused(), path(2) + ": has no velocities; " + path(1) + " has them (\"velocity\")");
  SignedDistances nothing = image_of_box(0, false);
  for (float& d : nothing.value) d = std::abs(d) + 0.1F;
  file("phi_1.vti", vti_of(image_of_box(0, false), 0.125));
  file("phi_2.vti", vti_of(nothing, 0.25));
  EXPECT_EQ(refused(), path(2) +
                           ": has nothing inside, no distance below 0; begin with a frame that has, by "
                           "--frames");
  EXPECT_FALSE(fs::exists(folder / "out"));
}

}  // namespace
}  // namespace kappaflow
