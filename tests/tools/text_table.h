// CSV files as rows of named texts.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "tests/tools/scratch.h"

namespace kappaflow {

using TextRow = std::map<std::string, std::string>;

inline std::vector<TextRow> read_table(const std::filesystem::path& path) {
  const std::vector<std::string> lines = split(bytes_of(path), '\n'), names = split(lines.at(0), ',');
  std::vector<TextRow> rows;
  for (std::size_t l = 1; l < lines.size(); ++l) {
    const std::vector<std::string> cells = split(lines[l], ',');
    EXPECT_EQ(cells.size(), names.size()) << lines[l];
    auto& row = rows.emplace_back();
    for (std::size_t c = 0; c < names.size(); ++c) row[names[c]] = cells.at(c);
  }
  return rows;
}

}  // namespace kappaflow
