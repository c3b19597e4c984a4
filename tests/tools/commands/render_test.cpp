#include <algorithm>
#include <csignal>
#include <cstdlib>

#include "core/stopwatch.h"
#include "tests/tools/everything_scene.h"
#include "tests/tools/image.h"
#include "tests/tools/program.h"
#include "tests/tools/scratch.h"

namespace kappaflow {
namespace {

class Render : public Scratch {
 protected:
  void SetUp() override {
    Scratch::SetUp();
    const ProgramResult result =
        run_program({"run", KAPPAFLOW_SOURCE_DIR "/scenes/staircase-small.toml", "--out", folder.string(),
                     "--duration", "0.01", "--track", "total,curvature"});
    ASSERT_EQ(result.exit_code, 0) << result.err;
  }
  ProgramResult render(const std::vector<std::string>& more,
                       const std::vector<std::string>& environment = {}) const {
    std::vector<std::string> words{"render", folder.string()};
    if (std::ranges::find(more, "--out") == more.end())
      words.insert(words.end(), {"--out", (folder / "a.png").string()});
    words.insert(words.end(), more.begin(), more.end());
    return run_program(words, environment);
  }
};

TEST_F(Render, WithoutADisplayAndWithoutXvfbIsOneLine) {
  for (const char* environment : {"DISPLAY", "DISPLAY=:4711"}) {
    const ProgramResult result = render({}, {environment, "PATH=/nowhere"});
    EXPECT_EQ(result.exit_code, 5);
    EXPECT_EQ(result.err,
              "kappaflow: error: DISPLAY: there is no display to draw with, and no Xvfb to make one; install "
              "xvfb\n");
  }
}

TEST_F(Render, WithoutADisplayAVirtualOneIsMade) {
  const ProgramResult result = render({}, {"DISPLAY"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(bytes_of(folder / "a.png").substr(0, 4), "\x89PNG");
}

TEST_F(Render, DamagedFilesAreOneLine) {
  const auto expect_refused = [&](const char* name, const std::string& bytes) {
    const std::string whole = bytes_of(folder / name);
    file(name, bytes);
    const ProgramResult result = render({});
    EXPECT_EQ(result.exit_code, 5) << name;
    EXPECT_EQ(result.err.find("kappaflow: error: " + (folder / name).string() + ": is "), 0u) << result.err;
    EXPECT_EQ(std::ranges::count(result.err, '\n'), 1) << result.err;
    file(name, whole);
  };
  for (const char* name : {"surface-curvature/surface_0001.vtp", "boundary.vtp"}) {
    const std::string whole = bytes_of(folder / name);
    expect_refused(name, whole.substr(0, whole.size() / 2));
    std::string damaged = whole;
    damaged.replace(whole.find("Points\"") + 200, 4, "////");
    expect_refused(name, damaged);
    expect_refused(name, "");
  }
  expect_refused("run.json", "{\"methods\": [7]}");
  EXPECT_EQ(render({}).exit_code, 0);
}

TEST_F(Render, WrongChoicesAreOneLine) {
  EXPECT_EQ(render({"--frame", "7"}).err,
            "kappaflow: error: " + folder.string() + " has frames 0 to 1, not 7\n");
  EXPECT_EQ(render({"--methods", "material"}).err,
            "kappaflow: error: " + folder.string() + " has no surface tracked with \"material\"\n");
  EXPECT_EQ(render({"--out", (folder / "a.jpg").string()}).err,
            "kappaflow: error: found \"" + (folder / "a.jpg").string() +
                "\"; expected a file name that ends in .png or .mp4\n");
  EXPECT_EQ(
      render({"--colour", "speed"}).err,
      "kappaflow: error: the surface has no array \"speed\"; it has Normals, TCoords, checker, confidence, "
      "gaussian_curvature, id, material_slip, mean_curvature, rest_position, source, unprojected, "
      "velocity\n");
  EXPECT_EQ(render({"--view", "0,-2,0"}).err,
            "kappaflow: error: the direction to the viewer and the one that is up must be neither zero nor "
            "parallel\n");
  EXPECT_EQ(render({"--size", "900"}).err,
            "kappaflow: error: --size: found \"900\"; expected WIDTH,HEIGHT; see kappaflow render --help\n");
  EXPECT_EQ(render({"--size", "900,20"}).err,
            "kappaflow: error: --size: found 20; expected whole numbers from 100 to 8000; see kappaflow "
            "render --help\n");
  EXPECT_EQ(render({"--fit", "liquids"}).err,
            "kappaflow: error: --fit: found \"liquids\"; expected one of liquid, scene (did you mean "
            "\"liquid\"?); see "
            "kappaflow render --help\n");
  EXPECT_EQ(render({"--fps", "10"}).err, "kappaflow: error: --fps is of films, whose names end in .mp4\n");
  EXPECT_EQ(render({"--frame", "0", "--out", (folder / "a.mp4").string()}).err,
            "kappaflow: error: --frame is of pictures, whose names end in .png\n");
}

/// Where values lie outside of the range, surfaces have the colours of its ends: dark violet and yellow.
TEST_F(Render, ColoursByAnyArray) {
  const auto count = [&](const char* range, bool yellow) {
    const ProgramResult result =
        render({"--colour", "velocity", "--methods", "total", "--range", range, "--view", "0,0.2,1"});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    const Image image(folder / "a.png");
    int pixels = 0;
    for (int y = 150; y < 700; ++y)  // between colour bar and title
      for (int x = 0; x < 900; ++x) {
        const int red = image.at(x, y, 0), green = image.at(x, y, 1), blue = image.at(x, y, 2);
        pixels += yellow ? red > blue + 50 && green > blue + 50 : red > green + 20 && blue > green + 20;
      }
    return pixels;
  };
  EXPECT_GT(count("1e3,1e4", false), 5000);
  EXPECT_EQ(count("1e3,1e4", true), 0);
  EXPECT_GT(count("-2,-1", true), 5000);
}

TEST_F(Render, AnArrayWithOneValueHasColoursToo) {
  EXPECT_EQ(render({"--colour", "unprojected"}).exit_code, 0);
}

TEST_F(Render, SourcesAreToldApart) {
  const std::string scene = file("everything.toml", kEverythingScene).string(),
                    out = (folder / "two").string();
  ASSERT_EQ(run_program({"run", scene, "--out", out, "--duration", "0.05", "--track", "material"}).exit_code,
            0);
  const std::string picture = (folder / "a.png").string();
  const ProgramResult result = run_program({"render", out, "--out", picture, "--colour", "source"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const Image image(picture);
  int green = 0, orange = 0;
  for (int y = 150; y < 700; ++y)  // between colour bar and title
    for (int x = 0; x < 900; ++x) {
      green += image.at(x, y, 1) > image.at(x, y, 0) + 30;
      orange += image.at(x, y, 0) > image.at(x, y, 2) + 30;
    }
  EXPECT_GT(green, 5000) << "the block";
  EXPECT_GT(orange, 2000) << "the stream";
}

/// Films with a program of that text in the place of ffmpeg.
class Film : public Render {
 protected:
  ProgramResult film(const std::string& ffmpeg) const {
    const auto program = file("ffmpeg", "#!/bin/sh\n" + ffmpeg);
    std::filesystem::permissions(program, std::filesystem::perms::owner_all);
    return run_program({"render", folder.string(), "--methods", "total", "--size", "300,260"},
                       {"PATH=" + folder.string() + ":" + std::getenv("PATH")});
  }
};

TEST_F(Film, GivesFfmpegAllFramesAtTheSpeedOfTheLiquid) {
  file("film.mp4", "the one before");
  std::filesystem::create_directory(folder / "film");
  file("film/frame_0002.png", "of a longer film before");
  const ProgramResult result = film("for last; do :; done; echo \"$@\" > \"$last\"; ls >> \"$last\"\n");
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const std::string film = (folder / "film.mp4").string();
  EXPECT_EQ(bytes_of(film),
            "-nostdin -loglevel error -y -framerate 100 -i frame_%04d.png -frames:v 2 -c:v libx264 "
            "-crf 18 -pix_fmt yuv420p -movflags +faststart -f mp4 " +
                film + ".tmp\nframe_0000.png\nframe_0001.png\n");
  EXPECT_EQ(result.out, film + ": 2 frames, 100 a second; each of them as a picture in " +
                            (folder / "film").string() + "\n");
}

// The folder of its name is the run's own, one of those in it, or somebody else's.
TEST_F(Film, HasItsPicturesApartFromOtherFiles) {
  file("ffmpeg", "#!/bin/sh\nfor last; do :; done; echo film > \"$last\"\n");
  std::filesystem::permissions(folder / "ffmpeg", std::filesystem::perms::owner_all);
  std::filesystem::create_directory(folder / "holiday");
  file("holiday/frame_0002.jpg", "mine");
  const auto expect_apart = [&](const std::filesystem::path& film) {
    const std::string pictures = film.parent_path() / ("frames-" + film.stem().string());
    const ProgramResult result = run_program(
        {"render", folder.string(), "--methods", "total", "--size", "300,260", "--out", film.string()},
        {"PATH=" + folder.string() + ":" + std::getenv("PATH")});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_TRUE(result.out.ends_with("each of them as a picture in " + pictures + "\n")) << result.out;
    EXPECT_TRUE(std::filesystem::exists(std::filesystem::path(pictures) / "frame_0001.png"));
    std::filesystem::remove_all(pictures);
    std::filesystem::remove(film);
  };
  expect_apart(folder.string() + ".mp4");
  for (const char* name : {"particles.mp4", "surface-total.mp4", "boundary.mp4", "holiday.mp4"})
    expect_apart(folder / name);
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
    EXPECT_NE(entry.path().extension(), ".png") << entry.path();
  std::filesystem::create_directory(folder / "frames-holiday");
  file("frames-holiday/frame_0002.jpg", "mine");
  EXPECT_EQ(render({"--out", (folder / "holiday.mp4").string()}).err,
            "kappaflow: error: " + (folder / "holiday").string() + " and " +
                (folder / "frames-holiday").string() +
                " hold other files than a film's pictures; name the film otherwise\n");
}

TEST_F(Film, IsAbsentWhereFfmpegFails) {
  const std::string film_name = (folder / "film.mp4").string(), pictures = (folder / "film").string();
  for (const auto& [script, reason] :
       {std::pair{"echo half > '" + film_name + ".tmp'; exit 1\n", "ffmpeg failed with status 1"},
        std::pair{std::string("exit 127\n"), "ffmpeg, which makes films, is not installed"}}) {
    const ProgramResult result = film(script);
    EXPECT_EQ(result.exit_code, 5);
    EXPECT_EQ(result.err, "kappaflow: error: " + film_name + ": " + reason +
                              "; the pictures of all frames are in " + pictures + "\n");
    EXPECT_FALSE(std::filesystem::exists(film_name));
    EXPECT_FALSE(std::filesystem::exists(film_name + ".tmp"));
    EXPECT_TRUE(std::filesystem::exists(folder / "film/frame_0001.png"));
  }
}

TEST_F(Render, FitsTheLiquidOrTheScene) {
  const auto share = [&](const std::vector<std::string>& more) {
    EXPECT_EQ(render(more).exit_code, 0);
    return blue_share(Image(folder / "a.png"));
  };
  const double liquid = share({"--frame", "0"}), scene = share({"--frame", "0", "--fit", "scene"});
  EXPECT_GT(liquid, 0.1);
  EXPECT_GT(scene, 0.002);
  EXPECT_GT(liquid, 5 * scene);
}

TEST_F(Film, IsAFilm) {
  if (std::system("command -v ffmpeg >/dev/null") != 0) GTEST_SKIP() << "ffmpeg is not installed";
  const auto film = folder / "a.mp4";
  const ProgramResult result =
      run_program({"render", folder.string(), "--out", film.string(), "--fps", "7.5"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(bytes_of(film).substr(4, 4), "ftyp");
  EXPECT_TRUE(std::filesystem::exists(folder / "a/frame_0001.png"));
}

TEST_F(Render, DrawsAPanelForEachMethod) {
  const ProgramResult result = render({"--frame", "0"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const Image image(folder / "a.png");
  EXPECT_EQ(image.data->GetDimensions()[0], 1800);
  EXPECT_EQ(image.data->GetDimensions()[1], 800);
  // Both panels show the same frame 0 and differ in their titles only; neither is blank.
  int blue_left = 0, blue_right = 0;
  for (int y = 0; y < 700; ++y)
    for (int x = 0; x < 900; ++x) {
      const auto is_blue = [&](int column) { return image.at(column, y, 2) > image.at(column, y, 0) + 60; };
      blue_left += is_blue(x);
      blue_right += is_blue(x + 900);
    }
  EXPECT_GT(blue_left, 5000);
  EXPECT_EQ(blue_left, blue_right);
}

/// Names of the processes that were started with this entry in their environment and do not end within a
/// second: who is told to end needs a moment.
std::vector<std::string> processes_with(const std::string& entry) {
  std::vector<std::string> found;
  for (const Stopwatch watch; watch.seconds() < 1;) {
    found.clear();
    for (const auto& process : std::filesystem::directory_iterator("/proc"))
      if (bytes_of(process.path() / "environ").find(entry) != std::string::npos)
        found.push_back(bytes_of(process.path() / "comm"));
    if (found.empty()) break;
  }
  return found;
}

/// Without a display, so that each has an X server of its own.
class EndsAtOnce : public Render {
 protected:
  void expect_end(const std::vector<std::string>& words, Stop stop) const {
    for (const int signal : {SIGINT, SIGTERM}) {
      stop.signal = signal;
      if (!stop.when.empty()) std::filesystem::remove(stop.when);
      const std::string mark = "KAPPAFLOW_TEST=" + folder.string();
      const ProgramResult result =
          run_program(words, {"DISPLAY", mark, "PATH=" + folder.string() + ":" + std::getenv("PATH")}, stop);
      EXPECT_EQ(result.exit_code, 128 + signal) << result.err;
      EXPECT_EQ(result.err, "");
      EXPECT_LT(result.seconds_to_end, 1);
      EXPECT_EQ(processes_with(mark), std::vector<std::string>()) << words[0];
      for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
        EXPECT_NE(entry.path().extension(), ".tmp") << entry.path();
    }
  }
};

TEST_F(EndsAtOnce, WhileTheDisplayStarts) {
  expect_end({"render", folder.string(), "--out", (folder / "a.png").string()}, {0, {}, 0.02});
}

TEST_F(EndsAtOnce, WhileAFilmIsDrawn) {
  expect_end({"render", folder.string()}, {0, folder / "film/frame_0000.png"});
}

TEST_F(EndsAtOnce, WhileFfmpegMakesTheFilm) {
  file("ffmpeg", "#!/bin/sh\nfor last; do :; done; echo half > \"$last\"; touch '" +
                     (folder / "begun").string() + "'; exec sleep 100\n");
  std::filesystem::permissions(folder / "ffmpeg", std::filesystem::perms::owner_all);
  expect_end({"render", folder.string()}, {0, folder / "begun"});
}

TEST_F(EndsAtOnce, WhileAnExperimentRuns) {
  const auto out = folder / "out";
  expect_end({"experiment", "fig9", "--quick", "--quiet", "--force", "--out", out.string()},
             {0, out / "fig9/run/surface-total/surface_0002.vtp"});
}

TEST_F(Render, WallsThatHideTheLiquidAreSeenThrough) {
  const auto tank = folder / "tank";
  ASSERT_EQ(run_program({"run", KAPPAFLOW_SOURCE_DIR "/scenes/splash.toml", "--out", tank.string(),
                         "--duration", "0.002"})
                .exit_code,
            0);
  const auto drawn_from = [&](const char* view) {
    const auto file = (folder / "tank.png").string();
    EXPECT_EQ(run_program({"render", tank.string(), "--out", file, "--view", view}).exit_code, 0);
    return blue_share(Image(file));
  };
  EXPECT_GT(drawn_from("0.2,0.1,1"), 0.015) << "from the side, through the walls";
  EXPECT_GT(drawn_from("0.01,1,0.1"), 0.015) << "from above";
}

}  // namespace
}  // namespace kappaflow
