// What people write on a command line beside what CLI11 understands, and what to say where it is not
// understood.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace kappaflow {

/// The elements of a list: what stands between its commas and blanks.
std::vector<std::string> list_elements(std::string_view list);

/// The words after the program's name as CLI11 takes them: `help run` becomes `run --help`; the values of an
/// option that takes several, with commas, blanks or both between them, become one word.
std::vector<std::string> understood_words(const CLI::App& app, std::vector<std::string> words);

/// What to say of the first word that the command line has no place for, with the likely one; of none at all
/// where there was no command either; else nothing. After app.parse(), whether it threw or not.
std::string misunderstood(const CLI::App& app);

}  // namespace kappaflow
