#include "tools/pictures/plot.h"

#include <cmath>

#include "core/errors.h"
#include "tests/tools/scratch.h"

namespace kappaflow {
namespace {

class Plots : public Scratch {};

TEST_F(Plots, AScriptWithItsDataAndAPicture) {
  const Plot plot{"It's a title", "x", "y", {{"a", {Vec2(1, 2), Vec2(2, std::nan("")), Vec2(3, 4)}}}, true};
  draw_plots(folder, "two", std::vector<Plot>{plot, plot});
  const std::string script = bytes_of(folder / "two.gp"), picture = bytes_of(folder / "two.png");
  EXPECT_NE(script.find("'It''s a title'"), std::string::npos);
  EXPECT_NE(script.find("1 2\n\n3 4\n"), std::string::npos) << "a value that is not finite leaves a gap";
  EXPECT_EQ(picture.substr(0, 4), "\x89PNG");
  EXPECT_GT(picture.size(), 5000u);
  EXPECT_FALSE(std::filesystem::exists(folder / "two.png.tmp"));
}

TEST_F(Plots, AFailureIsAnError) {
  const Plot nothing_to_draw{"", "", "", {{"a", {}}}, false};
  EXPECT_EQ(message_of<IoError>([&] { draw_plots(folder, "none", std::vector<Plot>{nothing_to_draw}); }),
            (folder / "none.gp").string() + ": gnuplot failed with status 1");
  EXPECT_FALSE(std::filesystem::exists(folder / "none.png"));
}

}  // namespace
}  // namespace kappaflow
