#include "tools/commands/command_words.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>

#include "core/suggestion.h"
#include "surface/tracker/surface_methods.h"
#include "tools/io/mesh_formats.h"

namespace kappaflow {
namespace {

std::vector<std::string> command_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands({})) names.push_back(command->get_name());
  return names;
}

std::vector<std::string> option_names(const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::Option* option : command.get_options())
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  return names;
}

std::string likely(const std::string& word, const std::vector<std::string>& names) {
  const std::vector<std::string_view> views(names.begin(), names.end());
  return suggestion(word, views);
}

std::string unknown_option(const std::string& word, const CLI::App& command) {
  const std::string name = word.substr(0, word.find('='));
  return fmt::format("unknown option \"{}\"{}", name, likely(name, option_names(command)));
}

/// Whether the option takes several values between commas.
bool takes_list(const CLI::Option& option) {
  return option.get_delimiter() == ',' || option.get_type_name().find(',') != std::string::npos;
}

/// Whether a word can be nothing else than a value of such an option: a number, a method's or a format's
/// name.
bool is_element(const std::string& word) {
  char* end = nullptr;
  std::strtod(word.c_str(), &end);
  const auto named = [&](const auto& named_thing) { return named_thing.name == word; };
  return *end == '\0' || std::ranges::any_of(surface_methods(), named) ||
         std::ranges::any_of(kMeshFormats, named);
}

bool goes_on(const std::string& list, const std::string& word) {
  const std::vector<std::string> elements = list_elements(word);
  if (!elements.empty() && std::ranges::all_of(elements, is_element)) return true;
  return !word.starts_with("-") && (list.ends_with(',') || word.starts_with(','));
}

std::vector<std::string> with_joined_lists(const CLI::App& command, const std::vector<std::string>& words) {
  std::vector<std::string> joined;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const std::string name = words[i].substr(0, words[i].find('='));
    const CLI::Option* option = name.starts_with("--") ? command.get_option_no_throw(name) : nullptr;
    const bool has_value = words[i].size() > name.size();
    joined.push_back(words[i]);
    if (option == nullptr || !takes_list(*option) || (!has_value && i + 1 == words.size())) continue;
    std::string list = has_value ? words[i].substr(name.size() + 1) : words[++i];
    while (i + 1 < words.size() && goes_on(list, words[i + 1])) list += "," + words[++i];
    joined.back() = name;
    joined.push_back(fmt::format("{}", fmt::join(list_elements(list), ",")));
  }
  return joined;
}

}  // namespace

std::vector<std::string> list_elements(std::string_view list) {
  constexpr std::string_view kBetween = ", \t\n";
  std::vector<std::string> elements;
  for (std::size_t end = 0;
       (list = list.substr(end)).find_first_not_of(kBetween) != std::string_view::npos;) {
    list = list.substr(list.find_first_not_of(kBetween));
    end = std::min(list.find_first_of(kBetween), list.size());
    elements.emplace_back(list.substr(0, end));
  }
  return elements;
}

std::vector<std::string> understood_words(const CLI::App& app, std::vector<std::string> words) {
  if (words.empty()) return words;
  if (words.front() == "help") {
    words.erase(words.begin());
    words.emplace_back("--help");
  }
  for (const CLI::App* command : app.get_subcommands({}))
    if (command->get_name() == words.front()) return with_joined_lists(*command, words);
  return words;
}

std::string misunderstood(const CLI::App& app) {
  const std::vector<std::string> before = app.remaining();
  if (app.get_subcommands().empty()) {
    if (before.empty())
      return fmt::format("no command; commands are {}", fmt::join(command_names(app), ", "));
    if (before.front().starts_with("-")) return unknown_option(before.front(), app);
    return fmt::format("unknown command \"{}\"{}", before.front(),
                       likely(before.front(), command_names(app)));
  }
  if (!before.empty()) return fmt::format("\"{}\" stands before the command", before.front());
  const CLI::App& command = *app.get_subcommands().front();
  const std::vector<std::string> left = command.remaining();
  for (const std::string& word : left)
    if (word.starts_with("-")) return unknown_option(word, command);
  return left.empty() ? "" : fmt::format("unexpected \"{}\"", left.front());
}

}  // namespace kappaflow
