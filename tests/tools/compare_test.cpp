#include "tools/compare.h"

#include "core/errors.h"
#include "tests/tools/scratch.h"
#include "tests/tools/text_table.h"

namespace kappaflow {
namespace {

class Compare : public Scratch {
 protected:
  std::filesystem::path run(const std::string& name, const std::string& rows) {
    std::filesystem::create_directories(folder / name);
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
  EXPECT_FALSE(std::filesystem::exists(folder / "out/texture_jump.png")) << "nobody has it";
}

TEST_F(Compare, RunsAreToldApartAndEqualsHaveNoBest) {
  const auto one = run("one", "0,0,total,0.4,1,0.5,1,1\n"), two = run("two", "0,0,total,0.4,1,0.5,1.25,1\n");
  const std::string text = compare({{one, two}, {}});
  EXPECT_NE(text.find(one.string() + ":total"), std::string::npos);
  EXPECT_NE(text.find(two.string() + ":total"), std::string::npos);
  for (const std::string& line : split(text, '\n'))
    EXPECT_EQ(line.ends_with("  " + one.string() + ":total"), line.starts_with("volume_error")) << line;
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
            (odd / "metrics.csv").string() + ": is not a table of metrics");
}

}  // namespace
}  // namespace kappaflow
