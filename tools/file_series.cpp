#include "tools/file_series.h"

#include <fmt/format.h>
#include <glob.h>

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <memory>

#include "core/errors.h"

namespace kappaflow {
namespace {

namespace fs = std::filesystem;

/// A name cut into its numbers and the texts around them: texts has one entry more.
struct NumberedName {
  fs::path file;
  std::vector<std::string> texts;
  std::vector<std::uint64_t> numbers;
};

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

NumberedName numbered(const std::string& file) {
  NumberedName name{file, {}, {}};
  const char *at = file.data(), *const end = at + file.size();
  while (true) {
    const char* const digits = std::find_if(at, end, is_digit);
    name.texts.emplace_back(at, digits);
    if (digits == end) return name;
    const auto [after, error] = std::from_chars(digits, end, name.numbers.emplace_back());
    if (error != std::errc()) throw InvalidInput({file}, "a number in the name is too long");
    at = after;
  }
}

struct FreeGlob {
  void operator()(glob_t* found) const { globfree(found); }
};

std::vector<std::string> expanded(std::span<const std::string> patterns) {
  std::vector<std::string> files;
  for (const std::string& pattern : patterns) {
    if (fs::is_directory(pattern))
      throw InvalidInput(fmt::format("{0} is a folder; name the files in it, e.g. '{0}/*.vtk'", pattern));
    if (fs::exists(pattern)) {  // a name, whatever characters it has
      files.push_back(pattern);
      continue;
    }
    glob_t found{};
    const std::unique_ptr<glob_t, FreeGlob> guard(&found);
    if (glob(pattern.c_str(), 0, nullptr, &found) != 0) throw IoError(pattern, "there is no such file");
    files.insert(files.end(), found.gl_pathv, found.gl_pathv + found.gl_pathc);
  }
  return files;
}

/// Which number the names differ in. Throws InvalidInput unless it is one, and all else is the same.
std::size_t varying_number(const std::vector<NumberedName>& names) {
  const NumberedName& first = names.front();
  std::size_t varying = first.numbers.size();
  for (const NumberedName& name : names) {
    bool same_series = name.texts == first.texts;
    for (std::size_t n = 0; same_series && n < first.numbers.size(); ++n) {
      if (name.numbers[n] == first.numbers[n]) continue;
      same_series = varying == first.numbers.size() || varying == n;
      varying = n;
    }
    if (!same_series)
      throw InvalidInput(
          fmt::format("{} and {} belong to different series; name the files of one, whose "
                      "names differ in one number",
                      first.file.string(), name.file.string()));
  }
  return varying;
}

std::string series_name(const NumberedName& name, std::size_t varying) {
  std::string before = name.texts[0];
  for (std::size_t n = 0; n < varying; ++n) before += std::to_string(name.numbers[n]) + name.texts[n + 1];
  before = fs::path(before).filename();
  before.erase(before.find_last_not_of("_-. ") + 1);
  return before.empty() ? "particles" : before;
}

std::string gap_in(const std::vector<NumberedName>& names, std::size_t varying) {
  const auto difference = [&](std::size_t i) {
    return names[i].numbers[varying] - names[i - 1].numbers[varying];
  };
  std::uint64_t smallest = difference(1);
  for (std::size_t i = 2; i < names.size(); ++i) smallest = std::min(smallest, difference(i));
  for (std::size_t i = 1; i < names.size(); ++i)
    if (difference(i) != smallest)
      return fmt::format("a file is missing: {} comes after {}, and elsewhere the number goes up by {}",
                         names[i].file.string(), names[i - 1].file.string(), smallest);
  return {};
}

}  // namespace

FileSeries file_series(std::span<const std::string> patterns) {
  std::vector<NumberedName> names;
  for (const std::string& file : expanded(patterns)) names.push_back(numbered(file));
  if (names.size() < 2)
    throw InvalidInput(
        fmt::format("{} is one file; a sequence takes two or more", names.front().file.string()));
  const std::size_t varying = varying_number(names);
  std::ranges::sort(names, {}, [](const NumberedName& name) { return std::pair(name.numbers, name.file); });
  for (std::size_t i = 1; i < names.size(); ++i)
    if (names[i].numbers == names[i - 1].numbers)
      throw InvalidInput(
          fmt::format("{} and {} have the same number", names[i - 1].file.string(), names[i].file.string()));
  FileSeries series;
  for (const NumberedName& name : names) series.files.push_back(name.file);
  series.name = series_name(names.front(), varying);
  series.gap = gap_in(names, varying);
  return series;
}

}  // namespace kappaflow
