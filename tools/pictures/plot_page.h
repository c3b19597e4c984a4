// A page for gnuplot to draw on: what all kinds of plots have in common. Lengths are in millimetres, those of
// type and lines in points.
#pragma once

#include <filesystem>
#include <string>

namespace kappaflow {

inline constexpr double kColumn = 89, kPage = 183;  // widths of journals
inline constexpr double kType = 7, kTitle = 8;
inline constexpr double kCharacter = 1.42;  // mean width

/// In double quotes: within braces gnuplot does not know those of single ones.
std::string quoted(const std::string& text);

/// About how wide it is.
double text_width(const std::string& text);

/// A script of data and drawing commands that draws `name`.png (200 dpi), .pdf and .svg, or, where the
/// variable `suffix` is set, files with it behind these names.
std::string page_script(const std::string& name, const std::string& data, double width, double height,
                        const std::string& drawing);

/// Writes the script as `name`.gp into the folder, and has it drawn. Throws IoError where gnuplot is missing
/// or fails.
void draw_page(const std::filesystem::path& folder, const std::string& name, const std::string& script);

}  // namespace kappaflow
