#include "tools/io/file_series.h"

#include <fmt/format.h>
#include <glob.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <iterator>
#include <memory>
#include <numeric>
#include <set>
#include <string_view>
#include <system_error>
#include <tuple>

#include "core/errors.h"
#include "core/parse_number.h"
#include "core/text_scanner.h"
#include "tools/io/input_frame.h"
#include "tools/io/input_kind.h"
#include "tools/io/parallel_vtk.h"
#include "tools/io/pvd_reader.h"

namespace kappaflow {
namespace {

namespace fs = std::filesystem;

/// A name cut into its numbers and the texts around them: texts has one entry more.
struct NumberedName {
  fs::path file;
  std::vector<std::string> texts;
  std::vector<std::string> digits;
  std::uint64_t number = 0;        ///< what the file is sorted by
  std::uint64_t rank = 0;          ///< of which it is a piece
  std::vector<fs::path> pieces{};  ///< of the frame whose first file it is
};

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

NumberedName numbered(const std::string& file) {
  NumberedName name{.file = file, .texts = {}, .digits = {}};
  const char *at = file.data(), *const end = at + file.size();
  while (true) {
    const char* const digits = std::find_if(at, end, is_digit);
    name.texts.emplace_back(at, digits);
    if (digits == end) return name;
    at = std::find_if_not(digits, end, is_digit);
    name.digits.emplace_back(digits, at);
  }
}

std::uint64_t value_of(const std::string& digits, const fs::path& file) {
  if (const auto value = parse_number<std::uint64_t>(digits)) return *value;
  throw InvalidInput({file.string()}, "a number in the name is too long");
}

struct FreeGlob {
  void operator()(glob_t* found) const { globfree(found); }
};

/// The name with the home folder for a ~ that begins it.
std::string with_home(const std::string& name) {
  const char* const home = std::getenv("HOME");
  return home != nullptr && name.starts_with("~/") ? home + name.substr(1) : name;
}

/// The pattern with what glob() takes for wildcards escaped in the names of folders that are there.
std::string with_literal_folders(const fs::path& pattern) {
  std::string escaped;
  fs::path folder;
  std::error_code ignored;  // a folder that cannot be examined is none
  for (const fs::path& part : pattern) {
    folder /= part;
    if (!escaped.empty() && escaped.back() != '/') escaped += '/';
    const bool literal = fs::is_directory(folder, ignored);
    for (const char c : part.string()) {
      if (literal && std::string_view("*?[]\\").find(c) != std::string_view::npos) escaped += '\\';
      escaped += c;
    }
  }
  return escaped;
}

/// The files in a folder that may be frames: those that may be particles where there are any, for walls may
/// lie beside them as meshes; of these those that list pieces where there are any, for the pieces may.
std::vector<std::string> files_in(const fs::path& folder) {
  std::vector<std::string> files, particles;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (!entry.is_regular_file()) continue;
    if (is_input_file(entry.path())) files.push_back(entry.path().string());
    if (is_particle_file(entry.path())) particles.push_back(entry.path().string());
  }
  if (!particles.empty()) files = particles;
  const auto is_list = [](const std::string& file) { return is_parallel_vtk(file); };
  if (std::ranges::any_of(files, is_list))
    std::erase_if(files, [&](const std::string& file) { return !is_list(file); });
  if (files.empty())
    throw InvalidInput(fmt::format("{}: there are no frames in this folder (expected {})", folder.string(),
                                   kInputFileKinds));
  std::ranges::sort(files);
  return files;
}

std::vector<std::string> expanded(std::span<const std::string> patterns) {
  std::vector<std::string> files;
  for (const std::string& given : patterns) {
    std::error_code ignored;  // what cannot be examined is looked for as a pattern
    const std::string pattern = with_home(given);
    if (fs::is_directory(pattern, ignored)) {
      std::ranges::move(files_in(pattern), std::back_inserter(files));
      continue;
    }
    if (fs::exists(pattern, ignored)) {  // a name, whatever characters it has
      files.push_back(pattern);
      continue;
    }
    glob_t found{};
    const std::unique_ptr<glob_t, FreeGlob> guard(&found);
    if (glob(with_literal_folders(pattern).c_str(), 0, nullptr, &found) != 0)
      throw IoError(given, "there is no such file");
    files.insert(files.end(), found.gl_pathv, found.gl_pathv + found.gl_pathc);
  }
  return files;
}

/// The number that the names differ in: digits from `begin` to `end`, of which there are two where it is a
/// decimal number.
struct VaryingNumber {
  std::size_t begin = 0, end = 0;
  int places = 0;  ///< after the point

  double value(std::uint64_t number) const { return static_cast<double>(number) / std::pow(10, places); }
};

std::string range_text(const FileRange& range) {
  return fmt::format("{}:{}{}", range.first, range.last,
                     range.stride == 1 ? std::string() : fmt::format(":{}", range.stride));
}

/// What the range leaves of the items, of which number_of() gives the number. Throws InvalidInput where that
/// is less than two.
template <class Item, class NumberOf>
void keep_range(std::vector<Item>& items, const FileRange& range, const NumberOf& number_of) {
  const double first = number_of(items.front()), last = number_of(items.back());
  std::erase_if(items, [&](const Item& item) {
    const double number = number_of(item);
    return number < range.first || number > range.last;
  });
  std::size_t kept = 0;
  for (std::size_t i = 0; i < items.size(); i += range.stride) std::swap(items[kept++], items[i]);
  items.resize(kept);
  if (kept < 2)
    throw InvalidInput(
        fmt::format("--frames {} leaves {} of the files numbered {} to {}; a sequence takes two or "
                    "more",
                    range_text(range), kept == 0 ? "none" : "one", first, last));
}

[[noreturn]] void refuse_as_different(const NumberedName& a, const NumberedName& b) {
  throw InvalidInput(
      fmt::format("{} and {} belong to different series; name the files of one, whose "
                  "names differ in one number{}",
                  a.file.string(), b.file.string(),
                  a.texts == b.texts ? ", or beside it in that of a rank (rank0, proc0, piece0, ...)" : ""));
}

/// Whether what follows the text is the number of a rank.
bool precedes_rank(std::string text) {
  static constexpr std::array<std::string_view, 8> kWords{"rank",  "proc",   "process", "processor",
                                                          "piece", "domain", "cpu",     "mpi"};
  text.erase(text.find_last_not_of("_-. =") + 1);
  const auto letter = [](char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0; };
  const auto word = std::find_if_not(text.rbegin(), text.rend(), letter).base();
  return std::ranges::count(kWords, lower_case({word, text.end()})) > 0;
}

bool differ_in(const std::vector<NumberedName>& names, std::size_t n) {
  return std::ranges::any_of(names, [&](const NumberedName& name) {
    return value_of(name.digits[n], name.file) != value_of(names.front().digits[n], names.front().file);
  });
}

bool differ_but_in(const std::vector<NumberedName>& names, std::size_t n) {
  for (std::size_t other = 0; other < names.front().digits.size(); ++other)
    if (other != n && differ_in(names, other)) return true;
  return false;
}

/// Takes the numbers of ranks that the names differ in, beside another number, out of them.
void take_ranks(std::vector<NumberedName>& names) {
  const NumberedName first = names.front();
  const auto same_texts = [&](const NumberedName& name) { return name.texts == first.texts; };
  if (!std::ranges::all_of(names, same_texts)) return;
  for (std::size_t n = first.digits.size(); n-- > 0;) {
    const auto rank = [&](const NumberedName& name) { return value_of(name.digits[n], name.file); };
    // What alone differs counts frames, whatever the word before it: domain_0, domain_1.
    if (!precedes_rank(first.texts[n]) || !differ_in(names, n) || !differ_but_in(names, n)) continue;
    for (NumberedName& name : names) {
      name.rank = rank(name);
      name.texts[n] += name.texts[n + 1];
      name.texts.erase(name.texts.begin() + static_cast<std::ptrdiff_t>(n) + 1);
      name.digits.erase(name.digits.begin() + static_cast<std::ptrdiff_t>(n));
    }
    return;
  }
}

/// Leaves one name a frame, with its pieces; of sorted names. Throws InvalidInput where frames have others.
void join_pieces(std::vector<NumberedName>& names) {
  std::vector<NumberedName> frames;
  std::vector<std::uint64_t> first_ranks, ranks;
  for (std::size_t i = 0; i < names.size();) {
    NumberedName& frame = frames.emplace_back(names[i]);
    ranks.clear();
    for (; i < names.size() && names[i].number == frame.number; ++i) {
      if (!ranks.empty() && ranks.back() == names[i].rank)
        throw InvalidInput(fmt::format("{} and {} have the same number", names[i - 1].file.string(),
                                       names[i].file.string()));
      ranks.push_back(names[i].rank);
      frame.pieces.push_back(names[i].file);
    }
    if (frames.size() == 1) first_ranks = ranks;
    if (ranks == first_ranks) continue;
    const auto [a, b] = std::ranges::mismatch(first_ranks, ranks);
    const bool lacks = b == ranks.end() || (a != first_ranks.end() && *a < *b);
    throw InvalidInput(fmt::format("the frame of {} has {} piece of rank {}, and that of {} has {}",
                                   frame.file.string(), lacks ? "no" : "a", lacks ? *a : *b,
                                   frames.front().file.string(), lacks ? "one" : "none"));
  }
  names = std::move(frames);
}

/// Which digits the names differ in, as many as there are. Throws InvalidInput where all else is not the
/// same.
VaryingNumber varying_digits(const std::vector<NumberedName>& names) {
  const NumberedName& first = names.front();
  VaryingNumber varying{first.digits.size(), 0};
  for (const NumberedName& name : names) {
    if (name.texts != first.texts) refuse_as_different(first, name);
    for (std::size_t n = 0; n < first.digits.size(); ++n) {
      if (value_of(name.digits[n], name.file) == value_of(first.digits[n], first.file)) continue;
      varying.begin = std::min(varying.begin, n);
      varying.end = std::max(varying.end, n + 1);
    }
    const bool decimal = varying.end == varying.begin + 2 && first.texts[varying.begin + 1] == ".";
    if (varying.end > varying.begin + 1 && !decimal) refuse_as_different(first, name);
  }
  return varying;
}

/// Whether the digits count something, as 8, 9, 10 or 08, 09, 10 do: no zeros in front but for equal lengths.
bool are_counters(const std::vector<NumberedName>& names, std::size_t n) {
  const std::size_t length = names.front().digits[n].size();
  const auto same_length = [&](const NumberedName& name) { return name.digits[n].size() == length; };
  const auto bare = [&](const NumberedName& name) {
    return name.digits[n].size() == 1 || !name.digits[n].starts_with('0');
  };
  return std::ranges::all_of(names, same_length) || std::ranges::all_of(names, bare);
}

/// Finds the number that the names differ in, and each one's. What follows a point is decimal places unless
/// it alone differs, and counts: run1.9, run1.10.
VaryingNumber read_numbers(std::vector<NumberedName>& names) {
  VaryingNumber varying = varying_digits(names);
  const std::size_t n = varying.begin;
  if (varying.end == n + 1 && n > 0 && names.front().texts[n] == "." && !are_counters(names, n))
    --varying.begin;
  const bool decimal = varying.end == varying.begin + 2;
  std::size_t places = 0;
  if (decimal)
    for (const NumberedName& name : names) places = std::max(places, name.digits[varying.begin + 1].size());
  varying.places = static_cast<int>(places);
  for (NumberedName& name : names) {
    if (varying.begin >= varying.end) continue;
    std::string digits = name.digits[varying.begin];
    if (decimal) {
      digits += name.digits[varying.begin + 1];
      digits.append(places - name.digits[varying.begin + 1].size(), '0');
    }
    name.number = value_of(digits, name.file);
  }
  return varying;
}

std::string series_name(const NumberedName& name, const VaryingNumber& varying) {
  std::string before = name.texts[0];
  for (std::size_t n = 0; n < varying.begin; ++n)
    before += std::to_string(value_of(name.digits[n], name.file)) + name.texts[n + 1];
  before = fs::path(before).filename();
  before.erase(before.find_last_not_of("_-. ") + 1);
  return before.empty() ? "particles" : before;
}

/// How much the number goes up from each file to the next.
std::vector<std::uint64_t> steps_of(const std::vector<NumberedName>& names) {
  std::vector<std::uint64_t> steps;
  for (std::size_t i = 1; i < names.size(); ++i) steps.push_back(names[i].number - names[i - 1].number);
  return steps;
}

/// The most frequent step. If several are, the one of them that most others are multiples of, then the
/// largest.
std::uint64_t usual_step(const std::vector<std::uint64_t>& steps) {
  const std::set<std::uint64_t> different(steps.begin(), steps.end());
  const auto rank = [&](std::uint64_t step) {
    const auto is_multiple = [&](std::uint64_t other) { return other % step == 0; };
    return std::tuple(std::ranges::count(steps, step), std::ranges::count_if(different, is_multiple), step);
  };
  return *std::ranges::max_element(different, {}, rank);
}

std::string gap_in(const std::vector<NumberedName>& names, const VaryingNumber& varying) {
  const std::vector<std::uint64_t> steps = steps_of(names);
  const std::uint64_t usual = usual_step(steps);
  const auto odd = std::ranges::find_if(steps, [&](std::uint64_t step) { return step != usual; });
  if (odd == steps.end()) return {};
  const auto i = odd - steps.begin();
  return fmt::format("{}{} comes after {}, and elsewhere the number goes up by {}",
                     *odd % usual == 0 ? "a file is missing: " : "the frames are not equally far apart: ",
                     names[i + 1].file.string(), names[i].file.string(), varying.value(usual));
}

void forget_lone_pieces(FileSeries& series) {
  if (std::ranges::all_of(series.pieces, [](const auto& pieces) { return pieces.size() == 1; }))
    series.pieces.clear();
}

/// Whether a part is of the same data set as the first one of its time.
bool is_piece_of(const PvdEntry& first, const PvdEntry& part) {
  return part.time == first.time && part.name == first.name &&
         numbered(part.file).texts == numbered(first.file).texts;
}

/// A time of a .pvd.
struct ListedFrame {
  PvdEntry first;
  std::vector<PvdEntry> parts;  // the first and those of the same data set
};

/// What has part 0 of each time, and the other parts of its data set, in whatever order they are listed.
/// Throws InvalidInput where times have different numbers of them.
std::vector<ListedFrame> listed_frames(const fs::path& pvd) {
  const std::vector<PvdEntry> all = read_pvd(pvd);
  std::vector<ListedFrame> frames;
  const auto frame_of = [&](const PvdEntry& part) {
    return std::ranges::find_if(frames, [&](const ListedFrame& f) { return is_piece_of(f.first, part); });
  };
  for (const PvdEntry& entry : all)
    if (entry.part == 0 && frame_of(entry) == frames.end()) frames.push_back({entry, {}});
  for (const PvdEntry& entry : all)
    if (const auto frame = frame_of(entry); frame != frames.end()) frame->parts.push_back(entry);
  for (ListedFrame& frame : frames) {
    std::ranges::stable_sort(frame.parts, {}, &PvdEntry::part);
    if (frame.parts.size() != frames.front().parts.size())
      throw InvalidInput({pvd.string()},
                         fmt::format("lists {} files at {} s, {}, but {} at {} s",
                                     frames.front().parts.size(), frames.front().first.time,
                                     frames.front().first.file, frame.parts.size(), frame.first.time));
  }
  return frames;
}

FileSeries listed_files(const fs::path& pvd, const FileRange& range) {
  std::vector<ListedFrame> entries = listed_frames(pvd);
  if (entries.size() < 2)
    throw InvalidInput(fmt::format("{} lists {}; a sequence takes two or more", pvd.string(),
                                   entries.empty() ? "no file" : "one file"));
  std::vector<std::size_t> kept(entries.size());
  std::iota(kept.begin(), kept.end(), std::size_t{0});
  keep_range(kept, range, [](std::size_t k) { return static_cast<double>(k); });
  FileSeries series;
  series.name = pvd.stem().string();
  series.stride = range.stride;
  for (const std::size_t k : kept) {
    std::vector<fs::path>& pieces = series.pieces.emplace_back();
    for (const PvdEntry& part : entries[k].parts) pieces.push_back(pvd.parent_path() / part.file);
    series.files.push_back(pieces.front());
    series.times.push_back(entries[k].first.time);
  }
  forget_lone_pieces(series);
  return series;
}

FileSeries numbered_files(std::span<const std::string> patterns, const FileRange& range) {
  std::vector<NumberedName> names;
  for (const std::string& file : expanded(patterns)) names.push_back(numbered(file));
  if (names.size() < 2)
    throw InvalidInput(
        fmt::format("{} is one file; a sequence takes two or more", names.front().file.string()));
  take_ranks(names);
  const VaryingNumber varying = read_numbers(names);
  std::ranges::sort(names, {},
                    [](const NumberedName& name) { return std::tuple(name.number, name.rank, name.file); });
  join_pieces(names);
  keep_range(names, range, [&](const NumberedName& name) { return varying.value(name.number); });
  FileSeries series;
  series.stride = range.stride;
  for (const NumberedName& name : names) {
    series.files.push_back(name.file);
    series.pieces.push_back(name.pieces);
  }
  forget_lone_pieces(series);
  series.name = series_name(names.front(), varying);
  series.step = varying.value(usual_step(steps_of(names))) / range.stride;
  series.is_decimal = varying.places > 0;
  series.gap = gap_in(names, varying);
  return series;
}

}  // namespace

FileSeries file_series(std::span<const std::string> patterns, const FileRange& range) {
  const bool is_list =
      patterns.size() == 1 && lower_case(fs::path(patterns[0]).extension().string()) == ".pvd";
  FileSeries series = is_list ? listed_files(with_home(patterns[0]), range) : numbered_files(patterns, range);
  series.backward = range.backward;
  if (range.backward) {
    std::ranges::reverse(series.files);
    std::ranges::reverse(series.pieces);
    std::ranges::reverse(series.times);
  }
  return series;
}

}  // namespace kappaflow
