#include "tools/commands/compare.h"

#include "core/errors.h"
#include "tests/tools/scratch.h"
#include "tests/tools/text_table.h"
#include "tools/runs/timings.h"

namespace kappaflow {
namespace {

class Compare : public Scratch {
 protected:
  std::filesystem::path run(const std::string& name, const std::string& rows,
                            const std::string& scene = "ball") {
    std::filesystem::create_directories(folder / name);
    file(name + "/run.json",
         "{\"methods\": [], \"scene\": {\"title\": \"A " + scene + "\", \"hash\": \"" + scene + "\"}}");
    file(name + "/metrics.csv",
         "frame,time,method,slip,rotation_captured,quality_min,volume,isosurface_volume\n" + rows);
    return folder / name;
  }
};

// Medians of three frames by hand: slip 0.4 and 0.1, rotation 1.2 and 0.95, quality 0.5 and 0.3, volumes off
// by a tenth and a fifth.
TEST_F(Compare, MediansAndWhoIsBest) {
  const auto one = run("one",
                       "0,0,total,0.4,1.2,0.5,1.1,1\n0,0,regional,,0.95,0.2,0.8,1\n"
                       "1,0.5,total,0.3,1.1,0.6,1.1,1\n1,0.5,regional,0.1,,0.3,0.8,1\n"
                       "2,1,total,0.9,1.5,0.4,1.1,1\n2,1,regional,0.05,0.9,0.4,0.8,1\n");
  const std::string text = compare({{one}, folder / "out"});
  EXPECT_TRUE(text.starts_with("median")) << text;
  std::map<std::string, TextRow> rows;
  for (const TextRow& row : read_table(folder / "out/compare.csv")) rows[row.at("median")] = row;
  const auto expect = [&](const char* metric, const char* total, const char* regional, const char* best) {
    EXPECT_EQ(rows[metric]["total"], total) << metric;
    EXPECT_EQ(rows[metric]["regional"], regional) << metric;
    EXPECT_EQ(rows[metric]["best"], best) << metric;
  };
  expect("slip", "0.4", "0.1", "regional");
  expect("rotation_captured", "1.2", "0.95", "regional");
  expect("quality_min", "0.5", "0.3", "total");
  expect("volume_error", "0.1", "0.2", "total");
  expect("volume", "1.1", "0.8", "");
  expect("texture_jump", "", "", "");
  EXPECT_NE(bytes_of(folder / "out/compare.md").find("| slip | 0.4 | 0.1 | regional |\n"), std::string::npos);
  EXPECT_EQ(bytes_of(folder / "out/slip.png").substr(0, 4), "\x89PNG");
  EXPECT_EQ(bytes_of(folder / "out/slip.pdf").substr(0, 4), "%PDF");
  EXPECT_NE(bytes_of(folder / "out/slip.svg").find("<text>regional</text>"), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(folder / "out/texture_jump.png")) << "nobody has it";
}

// What the surface takes in frames after the first, whose mesh the first method bears alone: medians 0.3 and
// 0.05 s.
TEST_F(Compare, TimeAFrameIsOfTheSurfaceAlone) {
  const auto one = run("one",
                       "0,0,total,0.4,1,0.5,1,1\n0,0,regional,0.4,1,0.5,1,1\n"
                       "1,1,total,0.4,1,0.5,1,1\n1,1,regional,0.4,1,0.5,1,1\n"
                       "2,2,total,0.4,1,0.5,1,1\n2,2,regional,0.4,1,0.5,1,1\n");
  file("one/timings.csv", timings_header() +
                              "0,0,total,9,7000,0,0,0,0,9,1\n0,0,regional,9,40,0,0,0,0,9,1\n"
                              "1,1,total,9,100,50,50,20,80,9,1\n1,1,regional,9,10,10,10,10,10,9,1\n"
                              "2,2,total,9,100,0,0,0,0,9,1\n2,2,regional,9,20,0,0,0,0,9,1\n");
  compare({{one}, folder / "out"});
  for (const TextRow& row : read_table(folder / "out/compare.csv"))
    if (row.at("median") == "time_a_frame") {
      EXPECT_EQ(row.at("total"), "0.3");
      EXPECT_EQ(row.at("regional"), "0.05");
      EXPECT_EQ(row.at("best"), "regional");
    }
  EXPECT_NE(bytes_of(folder / "out/time_a_frame.svg").find("time a frame [s]"), std::string::npos);
  file("one/timings.csv", timings_header() + "0,0,total\n");
  EXPECT_EQ(message_of<IoError>([&] {
              compare({{one}, {}});
            }),
            (one / "timings.csv").string() + ": row 1 has not as many cells as the table has columns");
}

TEST_F(Compare, RunsAreToldApartAndEqualsHaveNoBest) {
  const auto one = run("one", "0,0,total,0.4,1,0.5,1,1\n"), two = run("two", "0,0,total,0.4,1,0.5,1.25,1\n");
  const std::string text = compare({{one, two}, folder / "out"});
  EXPECT_TRUE(text.starts_with("1: " + one.string() + " (A ball, 1 frame to t = 0 s)\n2: " + two.string()))
      << text;
  EXPECT_EQ(text.find("The runs are not"), std::string::npos) << text;
  EXPECT_NE(text.find("\nmedian                1:total  2:total\n"), std::string::npos) << text;
  for (const std::string& line : split(text, '\n'))
    if (!line.starts_with("* ")) {
      EXPECT_EQ(line.find("0*") != std::string::npos, line.starts_with("volume_error")) << line;
    }
  for (const TextRow& row : read_table(folder / "out/compare.csv"))
    EXPECT_EQ(row.at("best"), row.at("median") == "volume_error" ? one.string() + ":total" : "");
}

TEST_F(Compare, PlotsNameRunsNotTheirPaths) {
  std::filesystem::create_directories(folder / "elsewhere");
  const char *one_row = "0,0,total,0.4,1,0.5,1,1\n1,1,total,0.3,1,0.5,1,1\n",
             *other_row = "0,0,total,0.2,1,0.5,1,1\n1,1,total,0.1,1,0.5,1,1\n";
  const auto one = run("one", one_row), two = run("two", other_row), same = run("elsewhere/one", other_row);
  compare({{one, two}, folder / "out"});
  const std::string plot = bytes_of(folder / "out/slip.svg");
  EXPECT_NE(plot.find("<text>one total</text>"), std::string::npos) << plot;
  EXPECT_NE(plot.find("<text>two total</text>"), std::string::npos) << plot;
  compare({{one, same}, folder / "same"});
  const std::string numbered = bytes_of(folder / "same/slip.svg");
  EXPECT_NE(numbered.find("<text>1 total</text>"), std::string::npos) << numbered;
  EXPECT_NE(numbered.find("<text>2 total</text>"), std::string::npos) << numbered;
}

// Slip: regional 4 % above curvature, which is noise, and half of total; material is 0 by definition. Where
// all are alike, as in rotation_captured, there is no best.
TEST_F(Compare, NeitherReferencesNorNoiseMakeABest) {
  const auto one =
      run("one",
          "0,0,total,0.2,0.97,0.5,1,1\n0,0,curvature,0.1,1.02,0.3,1,1\n"
          "0,0,regional,0.104,1.01,0.49,1,1\n0,0,material,0,1,0.9,1,1\n0,0,normal,1,0,0.9,1,1\n");
  const std::string text = compare({{one}, folder / "out"});
  std::map<std::string, TextRow> rows;
  for (const TextRow& row : read_table(folder / "out/compare.csv")) rows[row.at("median")] = row;
  EXPECT_EQ(rows["slip"]["best"], "curvature regional");
  EXPECT_EQ(rows["rotation_captured"]["best"], "");
  EXPECT_EQ(rows["quality_min"]["best"], "total regional");
  EXPECT_EQ(rows["slip"]["material"], "0") << "shown all the same";
  EXPECT_NE(text.find("\nslip                    0.2        0.1*    0.104*        0       1\n"),
            std::string::npos)
      << text;
}

TEST_F(Compare, SaysWhereRunsDifferInSceneOrLength) {
  const std::string long_rows = "0,0,total,0.4,1,0.5,1,1\n1,1,total,0.4,1,0.5,1,1\n2,2,total,0.9,1,0.5,1,1\n";
  const auto one = run("one", long_rows + "3,3,total,0.9,1,0.5,1,1\n"),
             two = run("two", "0,0,total,0.3,1,0.5,1,1\n1,1,total,0.3,1,0.5,1,1\n"),
             three = run("three", long_rows, "splash");
  const std::string lengths = compare({{one, two}, {}});
  EXPECT_NE(lengths.find("(A ball, 4 frames to t = 3 s)"), std::string::npos) << lengths;
  EXPECT_NE(lengths.find("The runs are not of the same length: medians are over t <= 1 s.\n"),
            std::string::npos)
      << lengths;
  EXPECT_NE(lengths.find("\nslip                      0.4      0.3*\n"), std::string::npos) << lengths;
  EXPECT_EQ(lengths.find("same scene"), std::string::npos) << lengths;
  const std::string scenes = compare({{one, three}, folder / "out"});
  EXPECT_NE(scenes.find("The runs are not of the same scene"), std::string::npos) << scenes;
  EXPECT_NE(bytes_of(folder / "out/compare.md").find("The runs are not of the same scene"),
            std::string::npos);
}

// The same particles, wherever their files are.
TEST_F(Compare, SequencesAreKnownByWhatIsInThem) {
  const auto tracked = [&](const std::string& name, const std::string& hash) {
    const std::filesystem::path made = run(name, "0,0,total,0.4,1.2,0.5,1.1,1\n");
    file(name + "/run.json", "{\"methods\": [], \"sequence\": {\"name\": \"frames\", \"first\": \"" + name +
                                 "/1.vtk\", \"last\": \"9.vtk\", \"hash\": \"" + hash + "\"}}");
    return made;
  };
  const auto here = tracked("here", "a"), there = tracked("there", "a"), other = tracked("other", "b");
  EXPECT_EQ(compare({{here, there}, folder / "out"}).find("not of the same scene"), std::string::npos);
  EXPECT_NE(compare({{here, other}, folder / "out"}).find("not of the same scene"), std::string::npos);
}

TEST_F(Compare, FitsTheTerminal) {
  std::string rows;
  for (const char* method :
       {"normal", "total", "curvature-only", "curvature", "curvature-first", "regional", "material"})
    rows += std::string("0,0,") + method + ",0.123456,0.9,0.5,1,1\n";
  const std::string text = compare({{run("one", rows), run("two", rows), run("three", rows)}, {}});
  for (const std::string& line : split(text, '\n'))
    if (!line.starts_with("1: ") && !line.starts_with("2: ") && !line.starts_with("3: ")) {
      EXPECT_LE(line.size(), 120u) << line;
    }
  for (const char* run : {"1", "2", "3"})
    EXPECT_NE(text.find(std::string(" ") + run + ":curvature-first "), std::string::npos) << text;
}

TEST_F(Compare, WhatIsNoRunIsSaid) {
  EXPECT_THROW(compare({{folder / "none"}, {}}), IoError);
  const auto empty = run("empty", ""), odd = run("odd", "1,2,3\n");
  EXPECT_EQ(message_of<IoError>([&] {
              compare({{empty}, {}});
            }),
            (empty / "metrics.csv").string() + ": holds no frames yet");
  EXPECT_EQ(message_of<IoError>([&] {
              compare({{odd}, {}});
            }),
            (odd / "metrics.csv").string() + ": row 1 has too few cells");
}

}  // namespace
}  // namespace kappaflow
