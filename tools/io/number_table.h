// Tables of numbers in CSV files.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace kappaflow {

/// A CSV file of finite numbers under a line that names its columns, as programs and people write them: cells
/// between commas, semicolons, tabs or blanks, with or without quotes, blanks and a byte order mark; decimal
/// commas where commas do not separate; names in upper or lower case and any order, with or without units in
/// brackets, also ParaView's (Points:0 is x, velocity:0 is vx); lines that end with \n, \r\n or \r; UTF-8 or
/// UTF-16. Blank lines and lines that begin with # are skipped, apart from names behind a #. Without names,
/// three columns are x, y, z, and six have vx, vy, vz too.
class NumberTable {
 public:
  /// allowed: the headers that are, for messages. Throws InvalidInput where columns have neither names nor
  /// a usual number; IoError.
  NumberTable(const std::filesystem::path& file, std::string allowed);

  /// Where the columns of these names (in lower case) stand; empty unless all are there. Throws InvalidInput
  /// where two have the same name.
  std::vector<std::size_t> find(std::span<const std::string_view> names) const;
  /// The numbers in these columns, row by row. Others may hold anything. Throws InvalidInput with file, line
  /// and column.
  std::vector<std::vector<double>> rows(std::span<const std::size_t> columns) const;
  /// Throws InvalidInput that says what was found and what is allowed.
  [[noreturn]] void refuse_header() const;

 private:
  void read_header();
  int header_line() const;

  std::filesystem::path file_;
  std::string allowed_, text_, header_;
  std::size_t body_ = 0;  // where in the text the rows begin
  int lines_above_ = 0;   // those
  bool has_names_ = true;
  char separator_ = ',';  // a blank: any number of blanks and tabs
  std::vector<std::string> names_,
      usual_names_;  // as the header has them in lower case; as they would be here
};

/// The rows of a table that has all columns of `header`, e.g. "x,y,z", in the order of the header. Throws as
/// NumberTable does.
std::vector<std::vector<double>> read_number_table(const std::filesystem::path& file,
                                                   std::string_view header);

}  // namespace kappaflow
