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
  expect_refused("run.json", "{\"methods\": [\"total\"], \"texture\": 7}");
  EXPECT_EQ(render({}).exit_code, 0);
}

TEST_F(Render, WrongChoicesAreOneLine) {
  EXPECT_EQ(render({"--frame", "7"}).err,
            "kappaflow: error: " + folder.string() + " has frames 0 to 1, not 7\n");
  EXPECT_EQ(render({"--methods", "material"}).err,
            "kappaflow: error: " + folder.string() + " has no surface tracked with \"material\"\n");
  EXPECT_EQ(render({"--out", (folder / "a.jpg").string()}).err,
            "kappaflow: error: found \"" + (folder / "a.jpg").string() +
                "\"; expected a file name that ends in .png, .mp4, .gif or .webp\n");
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
  EXPECT_EQ(render({"--fps", "10"}).err,
            "kappaflow: error: --fps is of films, whose names end in .mp4, .gif or .webp\n");
  EXPECT_EQ(render({"--frames", "0:1"}).err,
            "kappaflow: error: --frames is of films, whose names end in .mp4, .gif or .webp\n");
  for (const char* span : {"1:0", "1", ":1", "0:", "-1:1", "a:b", "0:1:2", "", "0:99999999999"})
    EXPECT_EQ(render({"--frames", span}).err, "kappaflow: error: --frames: found \"" + std::string(span) +
                                                  "\"; expected A:B, the numbers of a first and a last "
                                                  "frame; see kappaflow render --help\n");
  EXPECT_EQ(render({"--frames", "1:7", "--out", (folder / "a.gif").string()}).err,
            "kappaflow: error: " + folder.string() + " has frames 0 to 1, not 1:7\n");
  EXPECT_EQ(render({"--colour", (folder / "none.jpg").string()}).err,
            "kappaflow: error: " + (folder / "none.jpg").string() +
                ": cannot be read (No such file or directory)\n");
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
  const std::string chosen = bytes_of(picture);
  ASSERT_EQ(run_program({"render", out, "--out", picture}).exit_code, 0);
  EXPECT_EQ(bytes_of(picture), chosen) << "as by default: several sources flow";
  ASSERT_EQ(run_program({"render", out, "--out", picture, "--colour", "emission_time"}).exit_code, 0);
  EXPECT_NE(bytes_of(picture), chosen);
  ASSERT_EQ(run_program({"render", out, "--out", picture, "--colour", "source"}).exit_code, 0);
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
  ProgramResult film(const std::string& ffmpeg, const std::vector<std::string>& more = {}) const {
    const auto program = file("ffmpeg", "#!/bin/sh\n" + ffmpeg);
    std::filesystem::permissions(program, std::filesystem::perms::owner_all);
    std::vector<std::string> words{"render", folder.string(), "--methods", "total", "--size", "300,260"};
    words.insert(words.end(), more.begin(), more.end());
    return run_program(words, {"PATH=" + folder.string() + ":" + std::getenv("PATH")});
  }
  /// A film of both frames by the real ffmpeg.
  std::string real_film(const char* name, const char* size) const {
    const ProgramResult result = run_program({"render", folder.string(), "--methods", "total", "--size", size,
                                              "--fps", "20", "--out", (folder / name).string()});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return bytes_of(folder / name);
  }
  /// What ffprobe says of a film's pictures: these values, a line each.
  std::string probed(const char* name, const std::string& values) const {
    const std::string out = (folder / "probed").string();
    EXPECT_EQ(
        std::system(("ffprobe -v error -count_frames -select_streams v:0 -show_entries stream=" + values +
                     " -of default=nw=1:nk=1 '" + (folder / name).string() + "' >'" + out + "'")
                        .c_str()),
        0);
    return bytes_of(out);
  }
  static bool has_ffmpeg() { return std::system("command -v ffmpeg >/dev/null") == 0; }
};

TEST_F(Film, GivesFfmpegAllFramesAtTheSpeedOfTheLiquid) {
  file("film.mp4", "the one before");
  std::filesystem::create_directory(folder / "film");
  file("film/frame_0002.png", "of a longer film before");
  const ProgramResult result = film("for last; do :; done; echo \"$@\" > \"$last\"; ls >> \"$last\"\n");
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const std::string film = (folder / "film.mp4").string();
  EXPECT_EQ(bytes_of(film),
            "-nostdin -loglevel error -y -framerate 100 -start_number 0 -i frame_%04d.png -frames:v 2 "
            "-vf pad=ceil(iw/2)*2:ceil(ih/2)*2:color=white -c:v libx264 "
            "-crf 18 -pix_fmt yuv420p -movflags +faststart -f mp4 " +
                film + ".tmp\nframe_0000.png\nframe_0001.png\n");
  EXPECT_EQ(result.out, film + ": 2 frames, 100 a second; each of them as a picture in " +
                            (folder / "film").string() + "\n");
}

TEST_F(Film, IsOfTheFramesThatAreAskedFor) {
  file("film.mp4", "the one before");
  std::filesystem::create_directory(folder / "film");
  file("film/frame_0000.png", "of a longer film before");
  const ProgramResult result =
      film("for last; do :; done; echo \"$@\" > \"$last\"; ls >> \"$last\"\n", {"--frames", "1:1"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const std::string film = bytes_of(folder / "film.mp4");
  EXPECT_NE(film.find(" -start_number 1 -i frame_%04d.png -frames:v 1 "), std::string::npos) << film;
  EXPECT_TRUE(film.ends_with("film.mp4.tmp\nframe_0001.png\n")) << film;
  EXPECT_EQ(result.out.find((folder / "film.mp4").string() + ": 1 frames, "), 0u) << result.out;
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

TEST_F(Film, IsAFilmThatBrowsersPlay) {
  if (!has_ffmpeg()) GTEST_SKIP() << "ffmpeg is not installed";
  const std::string film = real_film("a.mp4", "301,261");
  EXPECT_EQ(film.substr(4, 4), "ftyp");
  EXPECT_LT(film.find("moov"), film.find("mdat")) << "begins before all of it is there";
  EXPECT_EQ(probed("a.mp4", "codec_name,width,height,pix_fmt,r_frame_rate,nb_read_frames"),
            "h264\n302\n262\nyuv420p\n20/1\n2\n");
  EXPECT_TRUE(std::filesystem::exists(folder / "a/frame_0001.png"));
}

TEST_F(Film, IsAGif) {
  if (!has_ffmpeg()) GTEST_SKIP() << "ffmpeg is not installed";
  const std::string film = real_film("a.gif", "301,261");
  EXPECT_EQ(film.substr(0, 6), "GIF89a");
  EXPECT_NE(film.find("NETSCAPE2.0"), std::string::npos) << "for ever";
  const std::size_t shown = film.find("\x21\xf9\x04");
  ASSERT_LT(shown + 5, film.size());
  EXPECT_EQ(film[shown + 4] + 256 * film[shown + 5], 5) << "hundredths of a second";
  EXPECT_EQ(probed("a.gif", "codec_name,width,height,nb_read_frames"), "gif\n301\n261\n2\n");
}

// From its chunks, for not every ffprobe reads moving ones.
TEST_F(Film, IsAMovingWebp) {
  if (!has_ffmpeg()) GTEST_SKIP() << "ffmpeg is not installed";
  const std::string film = real_film("a.webp", "301,261");
  const auto number = [&](std::size_t at, int bytes) {
    std::size_t value = 0;
    for (int k = bytes; k-- > 0;) value = 256 * value + static_cast<unsigned char>(film.at(at + k));
    return value;
  };
  ASSERT_EQ(film.substr(0, 4) + film.substr(8, 8), "RIFFWEBPVP8X");
  EXPECT_EQ(number(4, 4) + 8, film.size());
  EXPECT_EQ(number(24, 3) + 1, 301u);
  EXPECT_EQ(number(27, 3) + 1, 261u);
  std::vector<std::size_t> milliseconds;
  for (std::size_t at = 12; at < film.size(); at += 8 + (number(at + 4, 4) + 1) / 2 * 2)
    if (film.substr(at, 4) == "ANMF") milliseconds.push_back(number(at + 20, 3));
  EXPECT_EQ(milliseconds, (std::vector<std::size_t>{50, 50}));
}

// Pictures overlay: what is no liquid is the same, and liquid is in the same place.
TEST_F(Render, TheCameraIsTheSameWhateverIsColoured) {
  const auto drawn = [&](const char* name, const std::vector<std::string>& more) {
    std::vector<std::string> words{"--methods", "curvature", "--out", (folder / name).string()};
    words.insert(words.end(), more.begin(), more.end());
    EXPECT_EQ(render(words).exit_code, 0);
    return Image(folder / name);
  };
  const Image checker = drawn("checker.png", {}), grid = drawn("grid.png", {"--colour", "grid"}),
              violet = drawn("violet.png", {"--colour", "velocity", "--range", "1e3,1e4"}),
              yellow = drawn("yellow.png", {"--colour", "mean_curvature", "--range", "-2e9,-1e9"});
  const int bar = violet.data->GetDimensions()[1] - 800;
  ASSERT_EQ(bar, yellow.data->GetDimensions()[1] - 800);
  int liquid = 0, elsewhere = 0, moved = 0, changed = 0;
  for (int y = 0; y < 740; ++y)
    for (int x = 0; x < 900; ++x) {
      const auto channel = [&](const Image& image, int c) { return image.at(x, y + bar, c); };
      const bool is_violet = channel(violet, 0) > channel(violet, 1) + 20,
                 is_yellow = channel(yellow, 0) > channel(yellow, 2) + 20;
      (is_violet ? liquid : elsewhere) += 1;
      moved += is_violet != is_yellow;
      if (is_violet || is_yellow) continue;
      for (int c = 0; c < 3; ++c)
        changed += std::abs(checker.at(x, y, c) - channel(violet, c)) > 12 ||
                   std::abs(checker.at(x, y, c) - grid.at(x, y, c)) > 12;
    }
  EXPECT_GT(liquid, 50000);
  EXPECT_GT(elsewhere, 50000);
  EXPECT_LT(moved, 2500) << "the rim's pixels at most";
  EXPECT_LT(changed, 2500);
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
