#include "tools/runs/metrics.h"

#include <fmt/format.h>

#include <cmath>

#include "core/errors.h"
#include "tests/tools/scratch.h"

namespace kappaflow {
namespace {

TEST(MetricsTable, HasTheDocumentedColumns) {
  EXPECT_EQ(
      metrics_header(),
      "frame,time,method,particles,penetration_max,density_error_mean,density_error_max,"
      "viscosity_error,temperature_min,temperature_mean,temperature_max,vertices,triangles,residual_max,"
      "quality_min,quality_mean,area,volume,isosurface_"
      "volume,slip,rotation_captured,"
      "tracer_distance,components,genus,isosurface_components,isosurface_genus,kept_fraction,unprojected,"
      "folded_fraction,angles_outside,self_intersections,texture_jump,texture_cracks,texture_distance,"
      "texture_flicker,kept_since_frame,"
      "surface_without_mesh,mesh_without_surface,regions_replaced,regions_refused,"
      "components_on_lattice,genus_on_lattice,vertices_replaced,particles_outside,particles_taken,"
      "taken_by_region\n");
}

TEST(MetricsTable, RowMatchesTheHeader) {
  const FrameMetrics frame{7,  0.28, 1000, 0.25, 1.0 / 3.0, 0.02, 0.5, 300, 310.5, 320, {{0.75, {2, 3}}},
                           14, 15,   "7 8"};
  SurfaceMetrics surface;
  surface.vertices = 12;
  surface.triangles = 20;
  surface.residual_max = 1e-5;
  surface.quality = {0.5, 0.9};
  surface.size = {3.5, 0.625};
  surface.rotation_captured = 0.875;
  surface.topology = {1, 4};
  surface.unprojected = 5;
  surface.angles_outside = 0.125;
  surface.texture = {0.5, 0.25};
  surface.kept_since_frame = 0.875;
  surface.regions_replaced = 8;
  surface.regions_refused = 9;
  surface.judgement = {6, {10, 11}, 1.5, 2.5};
  surface.vertices_replaced = 13;
  EXPECT_EQ(metrics_row({frame, "total", surface}),
            "7,0.28,total,1000,0.25,0.333333333333,0.02,0.5,300,310.5,320,12,20,1e-05,0.5,0.9,3.5,0.625,0.75,"
            ",0.875,,1,4,2,3,1,"
            "5,0,0.125,6,0.5,0.25,,,0.875,1.5,2.5,8,9,10,11,13,14,15,7 8\n");
  EXPECT_EQ(split(metrics_row({frame, "total", surface}), ',').size(), split(metrics_header(), ',').size());
}

TEST(MetricsTable, WhatIsNotJudgedStaysEmpty) {
  MetricsRow row;
  row.frame.particles = 9;
  row.method = "regional";
  const std::vector<std::string> names = split(metrics_header(), ','), cells = split(metrics_row(row), ',');
  std::string empty;
  for (std::size_t c = 0; c < cells.size(); ++c)
    if (cells[c].empty()) empty += names[c] + " ";
  EXPECT_EQ(empty,
            "penetration_max density_error_mean density_error_max viscosity_error temperature_min "
            "temperature_mean temperature_max isosurface_volume slip "
            "rotation_captured tracer_distance isosurface_components isosurface_genus self_intersections "
            "texture_distance texture_flicker surface_without_mesh mesh_without_surface "
            "components_on_lattice genus_on_lattice ");
  MetricsRow read;
  for (std::size_t c = 0; c < metric_columns().size(); ++c) {
    EXPECT_EQ(cells[c].empty(), cells[c].empty() && std::isnan(metric_columns()[c].number(row)));
    metric_columns()[c].read(c + 1 == cells.size() ? cells[c].substr(0, cells[c].size() - 1) : cells[c],
                             read);
  }
  EXPECT_EQ(metrics_row(read), metrics_row(row));
}

// The page's table is the columns' own.
TEST(MetricsTable, ColumnsAreDocumentedAsTheyAre) {
  constexpr const char* kBetter[] = {"", "lower", "higher", "nearer to 1"};
  std::string table =
      "\n## Columns of metrics.csv\n\n| column | unit | better | meaning |\n|---|---|---|---|\n";
  for (const MetricColumn& column : metric_columns())
    table += fmt::format("| `{}` | {} | {} | {} |\n", column.name, column.unit,
                         kBetter[static_cast<int>(column.better)], column.meaning);
  const std::string page = bytes_of(KAPPAFLOW_SOURCE_DIR "/docs/outputs.md");
  EXPECT_NE(page.find(table + "\n"), std::string::npos) << "docs/outputs.md should have" << table;
}

TEST(MetricsTable, NumbersAreThoseOfTheCells) {
  FrameMetrics frame;
  frame.time = 0.5;
  SurfaceMetrics surface;
  surface.size.volume = 0.75;
  surface.unprojected = 3;
  const MetricsRow row{frame, "total", surface};
  const auto number = [&](const char* name) { return find_metric(name)->number(row); };
  EXPECT_EQ(number("time"), 0.5);
  EXPECT_EQ(number("volume"), 0.75);
  EXPECT_EQ(number("unprojected"), 3);
  EXPECT_TRUE(std::isnan(number("slip")));
  EXPECT_TRUE(std::isnan(number("method")));
  EXPECT_EQ(find_metric("volumes"), nullptr);
}

class MetricsFile : public Scratch {};

TEST_F(MetricsFile, IsReadBackToItsDigits) {
  const std::string
      first = "0,0,total,8,,,,,,,,1,2,3.5,4.5,5.5,6.5,7.5,8.5,,,,9,10,11,12,13.5,14,15.5,16.5,17,",
      rest = "18.5,19.5,19.625,19.75,20.5,21.5,22.5,23,24,25,26,27,28,29,14 15\n",
      second =
          "1,0.04,normal,8,0.25,1e-05,0.5,0.9,290,300,310,1,2,3.5,4.5,5.5,6.5,7.5,8.5,0.1,0.2,0.3,9,10,11,"
          "12,13.5,14,15.5,16.5,17,";
  const auto rows = read_metrics(file("metrics.csv", metrics_header() + first + rest + second + rest));
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(metrics_row(rows[0]), first + rest);
  EXPECT_EQ(metrics_row(rows[1]), second + rest);
  EXPECT_FALSE(rows[0].surface.slip.has_value());
  EXPECT_EQ(rows[1].surface.slip, 0.1);
  EXPECT_EQ(rows[1].frame.temperature_max, 310);
  EXPECT_EQ(rows[1].method, "normal");
  EXPECT_EQ(rows[1].surface.vertices_replaced, 27u);
  EXPECT_EQ(rows[1].frame.particles_outside, 28u);
  EXPECT_EQ(rows[1].frame.particles_taken, 29u);
  EXPECT_EQ(rows[1].frame.taken_by_region, "14 15");
}

TEST_F(MetricsFile, DamagedOnesAreOneLine) {
  const auto message = [&](const std::string& text) {
    const auto path = file("metrics.csv", text);
    return message_of<IoError>([&] { read_metrics(path); }).substr(path.string().size());
  };
  const std::string row = metrics_row({{}, "total", {}});
  EXPECT_EQ(message("frame,time\n"), ": is not a table of metrics of this version of kappaflow");
  EXPECT_EQ(message(metrics_header() + row + "1,0.04,total\n"), ": row 2 has too few cells");
  EXPECT_EQ(message(metrics_header() + row.substr(0, row.size() - 1) + ",7\n"), ": row 1 has too many cells");
  EXPECT_EQ(message(metrics_header() + "x" + row), ": row 1 has \"x0\" for a whole number");
  EXPECT_EQ(message(metrics_header() + "0,nul" + row.substr(3)),
            ": row 1 found \"nul\" where a number is needed");
}

// compare reads runs of earlier and later versions.
TEST_F(MetricsFile, OfAnotherVersionHasWhatBothKnow) {
  const auto path = file("metrics.csv", "new,time,method,slip,volume\nx,0,total,,2.5\n7,0,normal,0.5,3.5\n");
  const MetricsTable table = read_metrics_table(path);
  ASSERT_EQ(table.columns.size(), 4u);
  EXPECT_EQ(table.columns[2]->name, "slip");
  ASSERT_EQ(table.rows.size(), 2u);
  EXPECT_EQ(table.rows[0].method, "total");
  EXPECT_EQ(table.rows[0].surface.slip, std::nullopt);
  EXPECT_EQ(table.rows[1].surface.size.volume, 3.5);
  EXPECT_EQ(message_of<IoError>([&] { read_metrics(path); }),
            path.string() + ": is not a table of metrics of this version of kappaflow");
  for (const char* header : {"x,y\n", "time,method,slip,slip\n"}) {
    const auto other = file("other.csv", header);
    EXPECT_EQ(message_of<IoError>([&] { read_metrics_table(other); }),
              other.string() + ": is not a table of metrics");
  }
}

}  // namespace
}  // namespace kappaflow
