#include "tools/pictures/plot_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/errors.h"
#include "tools/io/files.h"
#include "tools/pictures/process.h"

namespace kappaflow {
namespace {

constexpr double kMillimetresPerInch = 25.4;
constexpr double kMark = 0.45;  // size, of gnuplot's
constexpr const char* kUnfinished = ".tmp";
constexpr const char* kFormats[] = {"png", "pdf", "svg"};

/// How a format's terminal is called, and what it makes of a type size, a line width and a mark of 1.
struct Terminal {
  const char *format, *name;
  double per_inch;  ///< of its unit of length; 0: it takes centimetres
  double type, line, mark;
  const char* more;
};
constexpr Terminal kTerminals[] = {
    {kFormats[0], "pngcairo", 200, 200.0 / 96, 2.4, 2.4, ""},
    {kFormats[1], "pdfcairo", 0, 0.75, 1.7, 1, ""},
    {kFormats[2], "svg", 96, 96.0 / 72, 1.15, 1.35, " background 'white'"},
};

/// The same type, lines and marks in all formats: a string for each that sets its terminal.
std::string terminals(double width, double height) {
  std::string lines;
  for (const Terminal& t : kTerminals) {
    const auto length = [&](double millimetres) {
      return t.per_inch > 0 ? fmt::format("{}", std::lround(millimetres / kMillimetresPerInch * t.per_inch))
                            : fmt::format("{:.4g}cm", millimetres / 10);
    };
    lines += fmt::format(
        "{} = \"set terminal {} size {},{} enhanced font 'sans-serif,{}' fontscale {:.4g} linewidth {}{}; "
        "mark = {:.4g}\"\n",
        t.format, t.name, length(width), length(height), kType, t.type, t.line, t.more, kMark * t.mark);
  }
  return lines;
}

}  // namespace

std::string quoted(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) result += c == '"' || c == '\\' ? std::string{'\\', c} : std::string(1, c);
  return result + "\" noenhanced";
}

double text_width(const std::string& text) {
  const auto begins = [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; };
  return kCharacter * static_cast<double>(std::ranges::count_if(text, begins));
}

std::string page_script(const std::string& name, const std::string& data, double width, double height,
                        const std::string& drawing) {
  return fmt::format("# gnuplot {0}.gp draws {0}.png, {0}.pdf and {0}.svg\n", name) + data +
         terminals(width, height) + "set encoding utf8\nif (!exists('suffix')) suffix = ''\n" +
         "do for [format in 'png pdf svg'] {\neval value(format)\n" +
         fmt::format("set output '{}.'.format.suffix\nset multiplot\n", name) + drawing +
         "unset multiplot\nunset output\n}\n";
}

void draw_page(const std::filesystem::path& folder, const std::string& name, const std::string& script) {
  const std::filesystem::path file = folder / (name + ".gp");
  write_file(file, script);
  const auto drawn = [&](const char* format) { return folder / fmt::format("{}.{}", name, format); };
  const auto unfinished = [&](const char* format) { return UnfinishedFile(drawn(format) += kUnfinished); };
  const UnfinishedFile files[] = {unfinished(kFormats[0]), unfinished(kFormats[1]), unfinished(kFormats[2])};
  const int status =
      run_command({"gnuplot", "-e", fmt::format("suffix = '{}'", kUnfinished), name + ".gp"}, folder);
  if (status != 0) throw IoError(file.string(), fmt::format("gnuplot failed with status {}", status));
  for (std::size_t k = 0; k < std::size(files); ++k) {
    std::error_code error;
    std::filesystem::rename(files[k].path(), drawn(kFormats[k]), error);
    if (error) throw IoError(drawn(kFormats[k]).string(), "cannot be written: " + error.message());
  }
}

}  // namespace kappaflow
