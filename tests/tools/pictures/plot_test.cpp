#include "tools/pictures/plot.h"

#include <zlib.h>

#include <cmath>
#include <cstdlib>

#include "core/errors.h"
#include "tests/tools/scratch.h"
#include "tools/pictures/cell_map.h"
#include "tools/pictures/plot_axis.h"
#include "tools/pictures/plot_labels.h"

namespace kappaflow {
namespace {

std::vector<std::string> texts_of(const Axis& axis) {
  std::vector<std::string> texts;
  for (const Tick& tick : axis.ticks)
    if (!tick.text.empty()) texts.push_back(tick.text);
  return texts;
}

using Texts = std::vector<std::string>;

TEST(PlotAxis, TicksAreRound) {
  const Axis time = axis_of(std::vector{0.0, 0.3, 3.0}, false, AxisEnds::of_data);
  EXPECT_EQ(texts_of(time), (Texts{"0", "0.5", "1.0", "1.5", "2.0", "2.5", "3.0"}));
  EXPECT_EQ(texts_of(axis_of(std::vector{0.05, 0.36, 0.4}, false, AxisEnds::of_data)),
            (Texts{"0.1", "0.2", "0.3", "0.4"}));
  const Axis signs = axis_of(std::vector{-0.19, 0.994}, false, AxisEnds::round);
  EXPECT_EQ(texts_of(signs), (Texts{"-0.2", "0", "0.2", "0.4", "0.6", "0.8", "1.0"}));
  EXPECT_DOUBLE_EQ(signs.low, -0.2);
  EXPECT_DOUBLE_EQ(signs.high, 1);
  EXPECT_EQ(texts_of(axis_of(std::vector{0.0, 1.9e-6}, false, AxisEnds::round)),
            (Texts{"0", "0.5·10^{-6}", "1·10^{-6}", "1.5·10^{-6}", "2·10^{-6}"}));
  for (const double size : {1e-7, 0.003, 0.7, 12.0, 4321.0, 9.9e8})
    for (const double share : {0.0, 0.3, 0.97}) {
      const Axis axis = axis_of(std::vector{share * size, size}, false, AxisEnds::round);
      EXPECT_GE(texts_of(axis).size(), 3u) << size << " " << share;
      EXPECT_LE(texts_of(axis).size(), 9u) << size << " " << share;
      EXPECT_LE(axis.low, share * size * (1 + 1e-9));
      EXPECT_GE(axis.high, size * (1 - 1e-9));
    }
}

TEST(PlotAxis, WholeNumbersHaveNoTicksBetween) {
  EXPECT_EQ(texts_of(axis_of(std::vector{1.0, 2.0, 3.0, 4.0}, false, AxisEnds::of_data)),
            (Texts{"1", "2", "3", "4"}));
}

TEST(PlotAxis, DecadesHaveTheirPowers) {
  EXPECT_EQ(texts_of(axis_of(std::vector{3e-6, 0.8}, true, AxisEnds::round)),
            (Texts{"10^{-6}", "10^{-5}", "10^{-4}", "10^{-3}", "10^{-2}", "10^{-1}", "10^{0}"}));
  EXPECT_EQ(texts_of(axis_of(std::vector{0.13, 0.9}, true, AxisEnds::round)),
            (Texts{"0.1", "0.2", "0.5", "1"}));
  const Axis wide = axis_of(std::vector{2e-17, 0.5}, true, AxisEnds::round);
  EXPECT_LE(texts_of(wide).size(), 9u);
  EXPECT_DOUBLE_EQ(wide.low, 1e-17);
  EXPECT_DOUBLE_EQ(wide.high, 1);
  EXPECT_NEAR(wide.share(std::sqrt(1e-17)), 0.5, 1e-12);
}

TEST(PlotAxis, LogarithmsWhereTheyTellMore) {
  std::vector<double> errors, line, zeros;
  for (int k = 0; k <= 100; ++k) {
    errors.push_back(1e-5 * std::pow(10, 0.04 * k));
    line.push_back(0.01 * k);
    zeros.push_back(k % 4 == 0 ? 1e-17 : 0.01 * k);
  }
  EXPECT_TRUE(spans_decades(errors));
  EXPECT_FALSE(spans_decades(line)) << "from 0 to 1";
  EXPECT_FALSE(spans_decades(zeros)) << "what is 0 but for rounding could not be shown";
  errors[50] = -1e-5;
  EXPECT_FALSE(spans_decades(errors));
  EXPECT_FALSE(spans_decades({}));
}

TEST(PlotLabels, AreApartAndInOrder) {
  const auto expect_near = [](const std::vector<double>& found, const std::vector<double>& expected) {
    ASSERT_EQ(found.size(), expected.size());
    for (std::size_t k = 0; k < found.size(); ++k) EXPECT_NEAR(found[k], expected[k], 1e-12) << k;
  };
  expect_near(spread_out({0.9, 0.1}, 0.1, 0, 1), {0.9, 0.1});
  expect_near(spread_out({0.5, 0.5, 0.9}, 0.1, 0, 1), {0.45, 0.55, 0.9});
  expect_near(spread_out({0.52, 0.5}, 0.1, 0, 1), {0.56, 0.46});
  expect_near(spread_out({1, 1, 1}, 0.1, 0, 1), {0.8, 0.9, 1});
  expect_near(spread_out({0, 0, 0}, 0.1, 0, 1), {0, 0.1, 0.2});
  expect_near(spread_out({0.3, 0.2, 0.1}, 0.8, 0, 1), {1, 0.5, 0});
}

/// A PDF with what it has compressed behind it: newer versions of cairo compress the pages' descriptions.
std::string with_streams(std::string pdf) {
  const std::string_view begin = "stream\n";
  const std::size_t end = pdf.size();
  for (std::size_t at = pdf.find(begin); at < end; at = pdf.find(begin, at + 1)) {
    std::string inflated(1 << 20, '\0');
    z_stream stream{};
    stream.next_in = reinterpret_cast<Bytef*>(pdf.data() + at + begin.size());
    stream.avail_in = static_cast<uInt>(end - at - begin.size());
    stream.next_out = reinterpret_cast<Bytef*>(inflated.data());
    stream.avail_out = static_cast<uInt>(inflated.size());
    inflateInit(&stream);
    inflate(&stream, Z_FINISH);  // of no interest where it is not compressed, or longer
    inflateEnd(&stream);
    pdf.append(inflated, 0, stream.total_out);
  }
  return pdf;
}

class Plots : public Scratch {
 protected:
  std::string text_of_pdf(const std::string& name) const {
    const std::string text = (folder / "text").string();
    const std::string command = "pdftotext '" + (folder / name).string() + "' '" + text + "' 2>/dev/null";
    return std::system(command.c_str()) == 0 ? bytes_of(text) : "";
  }
};

const Plot kPlot{
    "It's a \"title\"", "x", "y", {{"a_name", {Vec2(1, 2), Vec2(2, std::nan("")), Vec2(3, 4)}}}, true};

TEST_F(Plots, AScriptWithItsDataAndAPicture) {
  draw_plots(folder, "two", std::vector<Plot>{kPlot, kPlot});
  const std::string script = bytes_of(folder / "two.gp"), picture = bytes_of(folder / "two.png");
  EXPECT_NE(script.find("\"It's a \\\"title\\\"\""), std::string::npos) << script;
  EXPECT_NE(script.find("1 2\n\n3 4\n"), std::string::npos) << "a value that is not finite leaves a gap";
  EXPECT_EQ(script.find(" dt "), std::string::npos) << "dashes would be lost in noise";
  EXPECT_EQ(picture.substr(0, 4), "\x89PNG");
  EXPECT_GT(picture.size(), 5000u);
  for (const char* format : {"png", "pdf", "svg"})
    EXPECT_FALSE(std::filesystem::exists(folder / (std::string("two.") + format + ".tmp"))) << format;
}

// Journals' columns are 89 and 183 mm wide: 252 and 519 points, 336 and 692 of a browser's pixels.
TEST_F(Plots, EveryFormatIsAsWideAsAJournalsColumn) {
  draw_plots(folder, "one", std::vector<Plot>{kPlot});
  draw_plots(folder, "two", std::vector<Plot>{kPlot, kPlot});
  for (const auto& [name, svg, pdf] : {std::tuple{"one", "width=\"336\"", "/MediaBox [ 0 0 252 "},
                                       {"two", "width=\"692\"", "/MediaBox [ 0 0 51"}}) {
    const std::string drawing = bytes_of(folder / (std::string(name) + ".svg")),
                      document = with_streams(bytes_of(folder / (std::string(name) + ".pdf")));
    EXPECT_NE(drawing.find(svg), std::string::npos) << drawing.substr(0, 500);
    EXPECT_EQ(document.substr(0, 5), "%PDF-");
    EXPECT_NE(document.find(pdf), std::string::npos) << name;
  }
}

TEST_F(Plots, LabelsAreTexts) {
  draw_plots(folder, "one", std::vector<Plot>{kPlot});
  const std::string drawing = bytes_of(folder / "one.svg");
  for (const char* text : {"<text>It's a ", "<text>a_name</text>", "font-size=\"9.33\""})
    EXPECT_NE(drawing.find(text), std::string::npos) << text << "\n" << drawing;
  EXPECT_TRUE(drawing.ends_with("</svg>\n") || drawing.ends_with("</svg>\n\n"))
      << drawing.substr(drawing.size() - 40);
  const std::string words = text_of_pdf("one.pdf");
  if (words.empty()) GTEST_SKIP() << "pdftotext is not installed";
  for (const char* text : {"It's a \"title\"", "a_name"})
    EXPECT_NE(words.find(text), std::string::npos) << words;
}

TEST_F(Plots, LongNamesHaveTheWidthOfAPage) {
  Plot plot = kPlot;
  plot.curves.front().title = "a run with a long name: regional";
  draw_plots(folder, "one", std::vector<Plot>{plot});
  EXPECT_NE(bytes_of(folder / "one.svg").find("width=\"692\""), std::string::npos);
}

TEST_F(Plots, NothingToDrawMakesEmptyAxes) {
  draw_plots(folder, "none", std::vector<Plot>{{"", "x", "y", {{"a", {}}}}});
  EXPECT_NE(bytes_of(folder / "none.svg").find("<text>y</text>"), std::string::npos);
}

TEST_F(Plots, MapsHaveACellForEveryPair) {
  const std::vector<std::string> kinds{"neither", "this", "that", "both"};
  const CellMap map{"a_title",
                    "x",
                    "y",
                    {"1", "2"},
                    {"low", "high"},
                    {{0, "a", "b"}, {1, "c", "d"}, {2, "e", "f"}, {3, "g", "h"}}};
  draw_cell_maps(folder, "map", kinds, std::vector<CellMap>{map, map, map});
  const std::string drawing = bytes_of(folder / "map.svg"), script = bytes_of(folder / "map.gp");
  for (const char* text : {"a_title", "neither", "both", "a", "d", "h"})
    EXPECT_NE(drawing.find("<text>" + std::string(text) + "</text>"), std::string::npos) << text;
  EXPECT_NE(script.find("('low' 0.5, 'high' 1.5)"), std::string::npos) << "rows from below";
  EXPECT_NE(script.find("from 0,1 to 1,2 fc rgb '#a9d6f5'"), std::string::npos)
      << "the third: left, upper row";
  EXPECT_NE(drawing.find("width=\"692\""), std::string::npos);
  EXPECT_EQ(bytes_of(folder / "map.png").substr(0, 4), "\x89PNG");
}

TEST_F(Plots, AFailureIsAnError) {
  std::filesystem::create_directories(folder / "none.png.tmp");  // where gnuplot would write
  EXPECT_EQ(message_of<IoError>([&] { draw_plots(folder, "none", std::vector<Plot>{kPlot}); }),
            (folder / "none.gp").string() + ": gnuplot failed with status 1");
  EXPECT_FALSE(std::filesystem::exists(folder / "none.png"));
}

}  // namespace
}  // namespace kappaflow
