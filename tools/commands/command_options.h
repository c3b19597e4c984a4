// What the options of the commands have in common.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "surface/field/kernel_shapes.h"
#include "surface/motion/velocity.h"
#include "surface/tracker/surface_methods.h"
#include "tools/io/mesh_formats.h"

namespace kappaflow {

/// The end of a help text: the example, and the exit codes.
std::string footer(const std::string& example);

/// The methods by which surfaces follow the liquid, a line each; and the velocity methods alone.
std::string method_lines();
std::string velocity_method_lines();

/// Refuse words, and say what is allowed: finite numbers, described by `what`; whole numbers; names.
CLI::Validator number_in(const std::string& what, const std::function<bool(double)>& allowed);
CLI::Validator whole_number(long lowest, long highest);
CLI::Validator one_of(const std::vector<std::string_view>& names);

void add_threads(CLI::App& command, int& threads);

/// --shares: of the liquid, on several ranks.
void add_shares(CLI::App& command, std::vector<double>& shares);

/// --kernels.
void add_kernels(CLI::App& command, Kernels& kernels);

/// An option that takes names of methods, between commas.
void add_methods(CLI::App& command, const std::string& name, std::vector<std::string>& methods,
                 const std::string& text,
                 const std::vector<std::string_view>& allowed = surface_method_names());

/// --format: files for other programs. with_vtk: beside VTK's, which are always written; else of what there
/// is, usd where none is named.
void add_formats(CLI::App& command, std::vector<MeshFormat>& formats, bool with_vtk);

/// --force and --quiet. held: what the folder may already hold.
void add_force_and_quiet(CLI::App& command, const std::string& held, bool& force, bool& quiet);

/// --resume. more: what else help texts say of it.
CLI::Option* add_resume(CLI::App& command, std::filesystem::path& folder, const std::string& more);

/// An option that takes a number above 0.
void add_positive(CLI::App& command, const std::string& name, std::optional<double>& value,
                  const std::string& text);

/// An option that takes `count` numbers in one word, between commas, as `form` shows them; calls `set` with
/// them.
void add_numbers(CLI::App& command, const std::string& name, const std::string& form, std::size_t count,
                 const std::function<void(const std::vector<double>&)>& set, const std::string& text);

}  // namespace kappaflow
