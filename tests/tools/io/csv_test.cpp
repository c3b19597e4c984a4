#include "tools/io/csv.h"

#include <gtest/gtest.h>

#include <string>

namespace kappaflow {
namespace {

TEST(Csv, LinesEndInEveryWay) {
  const std::string text = "a\nb\r\nc\r\rlast";
  std::vector<std::string> lines;
  for (std::size_t at = 0; at < text.size();) lines.emplace_back(line_at(text, at));
  EXPECT_EQ(lines, (std::vector<std::string>{"a", "b", "c", "", "last"}));
}

TEST(Csv, CellsMayBeEmptyOrHoldSeparatorsInQuotes) {
  using Cells = std::vector<std::string_view>;
  EXPECT_EQ(csv_cells("1,,3,"), (Cells{"1", "", "3", ""}));
  EXPECT_EQ(csv_cells(""), (Cells{""}));
  EXPECT_EQ(csv_cells("\"a;b\"; c", ';'), (Cells{"\"a;b\"", " c"}));
}

}  // namespace
}  // namespace kappaflow
