#include "tools/commands/command_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <sstream>

#include "core/suggestion.h"
#include "surface/motion/velocity_methods.h"

namespace kappaflow {
namespace {

constexpr const char* kExitCodes =
    "Exit codes:\n"
    "  0 done   2 wrong input or command line   3 the simulation failed   4 broken mesh\n"
    "  5 a file cannot be read or written   130 interrupted (Ctrl-C)   143 ended (SIGTERM)";

/// Of methods that have a name and a summary.
std::string lines_of(const std::string& title, const auto& methods) {
  std::string text = title + ":\n";
  for (const auto& method : methods) text += fmt::format("  {:<16} {}\n", method.name, method.summary);
  return text;
}

}  // namespace

std::string footer(const std::string& example) {
  return "Example:\n  " + example + "\n\n" + kExitCodes;
}

std::string method_lines() {
  return lines_of("Methods", surface_methods());
}

std::string velocity_method_lines() {
  return lines_of("Velocity methods", velocity_methods());
}

// Validators see the words before CLI11 converts them; an empty result means that the word is fine.
CLI::Validator number_in(const std::string& what, const std::function<bool(double)>& allowed) {
  return CLI::Validator(
      [=](const std::string& word) {
        char* end = nullptr;
        const double value = std::strtod(word.c_str(), &end);
        const bool is_number = end != word.c_str() && *end == '\0' && std::isfinite(value);
        return is_number && allowed(value) ? std::string()
                                           : fmt::format("found \"{}\"; expected {}", word, what);
      },
      "");
}

CLI::Validator whole_number(long lowest, long highest) {
  return number_in(fmt::format("a whole number from {} to {}", lowest, highest), [=](double value) {
    return value == std::floor(value) && value >= static_cast<double>(lowest) &&
           value <= static_cast<double>(highest);
  });
}

CLI::Validator one_of(const std::vector<std::string_view>& names) {
  return CLI::Validator(
      [names](const std::string& word) {
        if (std::ranges::find(names, word) != names.end()) return std::string();
        return fmt::format("found \"{}\"; expected one of {}{}", word, fmt::join(names, ", "),
                           suggestion(word, names));
      },
      "");
}

void add_kernels(CLI::App& command, Kernels& kernels) {
  command
      .add_option_function<std::string>(
          "--kernels", [&kernels](const std::string& name) { kernels = *value_of(kKernels, name); },
          "Kernels of the particles: round, as in Eq. 12, or anisotropic, which make the surface smooth "
          "(default: round)")
      ->type_name("NAME")
      ->check(one_of({"round", "anisotropic"}));
}

void add_threads(CLI::App& command, int& threads) {
  command.add_option("--threads", threads, "Number of threads (default: all cores)")
      ->check(whole_number(1, 1024));
}

void add_shares(CLI::App& command, std::vector<double>& shares) {
  command
      .add_option("--shares", shares,
                  "On several ranks: how much of the liquid, or of the surfaces, each has, relative to the "
                  "others; benchmark says "
                  "what they should be (default: all the same)")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->type_name("NUMBERS")
      ->check(number_in("a number above 0", [](double number) { return number > 0; }));
}

void add_methods(CLI::App& command, const std::string& name, std::vector<std::string>& methods,
                 const std::string& text, const std::vector<std::string_view>& allowed) {
  command.add_option(name, methods, text)
      ->delimiter(',')
      ->allow_extra_args(false)
      ->type_name("NAMES")
      ->check(one_of(allowed));
}

void add_formats(CLI::App& command, std::vector<MeshFormat>& formats, bool with_vtk) {
  const auto set = [&formats](const std::vector<std::string>& names) {
    for (const Named<MeshFormat>& format : kMeshFormats)
      if (std::ranges::find(names, format.name) != names.end()) formats.push_back(format.value);
  };
  std::vector<std::string_view> names{"obj", "ply", "glb", "usd"};
  if (with_vtk) names.insert(names.begin(), "vtk");
  command
      .add_option_function<std::vector<std::string>>(
          "--format", set,
          with_vtk ? "Files: vtk (always written), obj, ply, glb, usd (default: vtk)"
                   : "Files to write: obj, ply, glb, usd (default: usd)")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->type_name("NAMES")
      ->check(one_of(names));
}

void add_force_and_quiet(CLI::App& command, const std::string& held, bool& force, bool& quiet) {
  command.add_flag("--force", force, fmt::format("Replace the {} that the folder already holds", held));
  command.add_flag("--quiet", quiet, "Print errors only");
}

CLI::Option* add_resume(CLI::App& command, std::filesystem::path& folder, const std::string& more) {
  return command
      .add_option("--resume", folder,
                  "Go on with the interrupted run in this folder, with its options" + more)
      ->type_name("DIR");
}

void add_positive(CLI::App& command, const std::string& name, std::optional<double>& value,
                  const std::string& text) {
  command
      .add_option_function<double>(
          name, [&value](double number) { value = number; }, text)
      ->type_name("NUMBER")
      ->check(number_in("a number above 0", [](double number) { return number > 0; }));
}

void add_numbers(CLI::App& command, const std::string& name, const std::string& form, std::size_t count,
                 const std::function<void(const std::vector<double>&)>& set, const std::string& text) {
  const auto set_words = [=](const std::string& word) {
    std::vector<double> numbers(count);
    std::istringstream stream(word);
    char comma = ',';
    for (std::size_t i = 0; i < count && comma == ','; ++i) {
      stream >> numbers[i];
      if (i + 1 < count) stream >> comma;
    }
    if (!stream || comma != ',' || stream.peek() != EOF ||
        !std::ranges::all_of(numbers, [](double x) { return std::isfinite(x); }))
      throw CLI::ValidationError(name, fmt::format("found \"{}\"; expected {}", word, form));
    set(numbers);
  };
  command.add_option_function<std::string>(name, set_words, text)->type_name(form);
}

}  // namespace kappaflow
