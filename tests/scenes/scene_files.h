// Where the tests' files are, and scenes that exist for one test only.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

#include "core/errors.h"
#include "core/read_file.h"
#include "scenes/prepared_scene.h"

namespace kappaflow {

inline std::filesystem::path source_file(std::string_view path) {
  return std::filesystem::path(KAPPAFLOW_SOURCE_DIR) / path;
}

/// All files of a folder with the given ending, sorted by name.
inline std::vector<std::filesystem::path> files_in(const std::filesystem::path& folder,
                                                   std::string_view ending) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    if (entry.path().extension() == ending) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

inline void add_wall(Scene& scene, const decltype(Wall::shape)& shape) {
  scene.walls.emplace_back().shape = shape;
}
inline void add_block(Scene& scene, const decltype(FluidBlock::shape)& shape,
                      const Vec3& velocity = Vec3::Zero()) {
  FluidBlock& block = scene.blocks.emplace_back();
  block.shape = shape;
  block.velocity = velocity;
}

/// Writes a file in the test's own temporary folder.
inline std::filesystem::path temporary_file(std::string_view name, std::string_view bytes) {
  const auto& test = *testing::UnitTest::GetInstance()->current_test_info();
  const auto file =
      std::filesystem::path(testing::TempDir()) / "kappaflow" / test.test_suite_name() / test.name() / name;
  std::filesystem::create_directories(file.parent_path());
  std::ofstream(file, std::ios::binary) << bytes;
  return file;
}

/// The message of the InvalidInput that loading and preparing throws, without the folder of the scene; empty
/// where there is none.
inline std::string load_error(const std::filesystem::path& file) {
  std::string message;
  try {
    prepare(load_scene(file));
  } catch (const InvalidInput& error) {
    message = error.what();
  }
  const std::string folder = file.parent_path().string() + "/";
  for (std::size_t at = message.find(folder); at != std::string::npos; at = message.find(folder))
    message.erase(at, folder.size());
  return message;
}

}  // namespace kappaflow
