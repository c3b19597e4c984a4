#include "tools/number_table.h"

#include "core/errors.h"
#include "tests/tools/scratch.h"

namespace kappaflow {
namespace {

class NumberTable : public Scratch {
 protected:
  std::string error(const std::string& text) {
    const auto path = file("t.csv", text);
    return message_of<InvalidInput>([&] { read_number_table(path, "x,y"); }).substr(path.string().size());
  }
};

TEST_F(NumberTable, ReadsNumbersExactly) {
  const auto rows =
      read_number_table(file("t.csv", "x,y\r\n 1e-300 ,-0.1\r\n\r\n0.30000000000000004,5"), "x,y");
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0], (std::vector<double>{1e-300, -0.1}));
  EXPECT_EQ(rows[1], (std::vector<double>{0.1 + 0.2, 5}));
  EXPECT_TRUE(read_number_table(file("t.csv", "x,y\n"), "x,y").empty());
}

TEST_F(NumberTable, SaysWhereAndWhatIsWrong) {
  EXPECT_EQ(error(""), ":1: found the header \"\"; expected \"x,y\"");
  EXPECT_EQ(error("a,b\n1,2\n"), ":1: found the header \"a,b\"; expected \"x,y\"");
  EXPECT_EQ(error("x,y\n1,2\n1,2,3\n"), ":3: found 3 values; expected 2");
  EXPECT_EQ(error("x,y\n1,two\n"), ":2:3: found \"two\"; expected a finite number");
  EXPECT_EQ(error("x,y\n,2\n"), ":2:1: found \"\"; expected a finite number");
  EXPECT_EQ(error("x,y\n1,nan\n"), ":2:3: found \"nan\"; expected a finite number");
  EXPECT_EQ(error("x,y\n1,1e999\n"), ":2:3: found \"1e999\"; expected a finite number");
  EXPECT_EQ(error("x,y\n1,2x\n"), ":2:3: found \"2x\"; expected a finite number");
}

TEST_F(NumberTable, MissingFileIsAnIoError) {
  EXPECT_THROW(read_number_table(folder / "none.csv", "x,y"), IoError);
}

}  // namespace
}  // namespace kappaflow
