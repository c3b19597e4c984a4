#include "tools/io/number_table.h"

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

TEST_F(NumberTable, FindsColumnsByNameAsProgramsAndPeopleWriteThem) {
  const std::vector<std::vector<double>> expected{{1, -2.5}, {3, 4}};
  for (const char* text : {"\xEF\xBB\xBFx,y\n1,-2.5\n3,4\n",
                           "X , Y\n1 , -2.5\n3,\t4\n",
                           "\"x\",\"y\"\n\"1\",\"-2.5\"\n3,4",
                           "y,name,x\n-2.5,a word,1\n4,,3\n",
                           "x;y\n1;-2.5\n3;4\n",
                           "x;y;\n1;-2.5;\n3;4;\n",
                           "# x,y\n1,-2.5\n3,4\n",
                           "#x;y\n1;-2.5\n3;4\n",
                           "x,y\r1,-2.5\r3,4\r",
                           "x,y\r\n1,-2.5\r\n\r\n3,4\r\n",
                           "\"Point ID\",\"Points:0\",\"Points:1\",\"Points:2\"\n0,1,-2.5,9\n1,3,4,9\n",
                           "pos.x,pos.y\n1,-2.5\n3,4\n",
                           "Points_0,x,Points_1\n8,1,-2.5\n8,3,4\n",
                           "\"x\",\"a, b\",\"y\"\n1,\"c, d\",-2.5\n3,,4\n",
                           "x y\n1   -2.5\n\n  3 4 \n",
                           "x\ty\n1\t-2.5\n3\t4\n",
                           "x;y\n1,0;-2,5\n3;4\n",
                           "x\ty\n1\t-2,5\n+3\t4\n",
                           "# by hand\n# 2026\nx,y\n1,-2.5\n# half\n3,4\n",
                           "# x y\n1.0 -2.5\n3.0e0 4\n",
                           "Pos.x [m];Pos.y [m];Idp\n1;-2.5;7\n3;4;8\n",
                           "1 -2.5 9\n3 4 9\n",
                           "# no names here at all\n1,-2.5,9,8,7,6\n3,4,9,8,7,6\n"})
    EXPECT_EQ(read_number_table(file("t.csv", text), "x,y"), expected) << text;
  const auto velocity =
      read_number_table(file("t.csv", "Velocity:1,velocity_0,vel.z,V_2,vz\n1,2,3,4,5\n"), "vx,vy,vz");
  EXPECT_EQ(velocity, (std::vector<std::vector<double>>{{2, 1, 5}}));
}

TEST_F(NumberTable, SaysWhereAndWhatIsWrong) {
  EXPECT_EQ(error(""), ":1: found the header \"\"; expected x,y, in any order");
  EXPECT_EQ(error("a,b\n1,2\n"), ":1: found the header \"a,b\"; expected x,y, in any order");
  EXPECT_EQ(error("x,y,x\n1,2,3\n"), ":1: several columns are \"x\"; expected one");
  EXPECT_EQ(error("x,y\n0,1\n\"0,5\",1\n"),
            ":3:1: found \"0,5\"; expected a finite number with a decimal point");
  EXPECT_EQ(error("x;y\n0;1\n1,000,5;1\n"),
            ":3:1: found \"1,000,5\"; expected a finite number with a decimal point");
  EXPECT_EQ(error("# a comment\n1,2\n"),
            ":1: found 2 columns without names; expected a line of names above: x,y, in any order");
  EXPECT_EQ(error("x,y\n1,2\n1,2,3\n"), ":3: found 3 values; expected 2");
  EXPECT_EQ(error("x,y\n1,two\n"), ":2:3: found \"two\"; expected a finite number");
  EXPECT_EQ(error("x,y\n,2\n"), ":2:1: found \"\"; expected a finite number");
  EXPECT_EQ(error("x,y\n1,nan\n"), ":2:3: found \"nan\"; expected a finite number");
  EXPECT_EQ(error("x,y\n1,1e999\n"), ":2:3: found \"1e999\"; expected a finite number");
  EXPECT_EQ(error("x,y\n1,2x\n"), ":2:3: found \"2x\"; expected a finite number");
}

TEST_F(NumberTable, UTF16IsReadAsPowerShellWritesIt) {
  for (const bool little : {true, false}) {
    std::string text = little ? "\xFF\xFE" : "\xFE\xFF";
    for (const char c : std::string("x,y\r\n1,-2.5\r\n"))
      text += little ? std::string{c, '\0'} : std::string{'\0', c};
    EXPECT_EQ(read_number_table(file("t.csv", text), "x,y"), (std::vector<std::vector<double>>{{1, -2.5}}));
  }
}

TEST_F(NumberTable, MissingFileIsAnIoError) {
  EXPECT_THROW(read_number_table(folder / "none.csv", "x,y"), IoError);
}

}  // namespace
}  // namespace kappaflow
