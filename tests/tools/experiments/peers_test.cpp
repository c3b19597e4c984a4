#include "tools/experiments/peers.h"

#include "core/errors.h"
#include "tests/tools/scratch.h"

namespace kappaflow {
namespace {

class Peers : public Scratch {
 protected:
  /// Of an experiment whose file lies in `scenes`.
  ExperimentContext context(const std::filesystem::path& scenes) const {
    return {options_, scenes / "fig.toml", folder, "fig"};
  }

  ExperimentOptions options_;
  const std::filesystem::path scenes_ = KAPPAFLOW_SOURCE_DIR "/scenes/experiments";
};

// The figure's first and last point, and what the paper says.
TEST_F(Peers, FiguresAreThoseOfTheirSources) {
  const MeasuredFronts fronts = measured_fronts(context(scenes_));
  EXPECT_EQ(fronts.name, "Martin & Moyce 1952");
  ASSERT_EQ(fronts.points.size(), 7u);
  EXPECT_EQ(fronts.points.front(), Vec2(0.832, 1.217));
  EXPECT_EQ(fronts.points.back(), Vec2(4.418, 5.881));
  const MeasuredOutlines outlines = measured_outlines(context(scenes_));
  ASSERT_EQ(outlines.outlines.size(), 3u);
  EXPECT_EQ(outlines.outlines.front().time, 32);
  EXPECT_EQ(outlines.outlines.front().points.front(), Vec2(-0.05294, 0.00024));
  EXPECT_EQ(outlines.outlines.back().points.back(), Vec2(0.24485, 0));
  EXPECT_EQ(paper_figures(context(scenes_)).faired_error, 0.03);
  EXPECT_EQ(paper_figures(context(scenes_)).total_after_30_turns, 0.06);
  const Table programs = enright_programs(context(scenes_));
  ASSERT_EQ(programs.rows.size(), 3u);
  EXPECT_EQ(programs.rows[0].front(), "El Topo");
}

TEST_F(Peers, MistakesAreNamedWithTheirPlace) {
  std::filesystem::create_directories(folder / "data");
  const auto message_for = [&](const std::string& name, const std::string& text, const auto& read) {
    file("data/" + name, text);
    return message_of<InvalidInput>([&] { read(context(folder)); });
  };
  EXPECT_NE(message_for("martin_moyce_1952.toml", "name = \"x\"\nfigure = \"y\"\nT = [2, 1]\nZ = [1, 2]\n",
                        measured_fronts)
                .find("martin_moyce_1952.toml:3:5: T in the figures is"),
            std::string::npos);
  EXPECT_NE(message_for("martin_moyce_1952.toml", "name = \"x\"\nfigure = \"y\"\nT = [1, 2]\nZ = [1]\n",
                        measured_fronts)
                .find("a front for each of 2 times"),
            std::string::npos);
  EXPECT_NE(message_for("lister_1992.toml",
                        "name = \"x\"\nfigure = \"y\"\n[[outline]]\ntime = 1\nx = [1, 2]\ny = [1]\n",
                        measured_outlines)
                .find("a number for each of 2 of x"),
            std::string::npos);
  EXPECT_NE(message_for("lister_1992.toml",
                        "name = \"x\"\nfigure = \"y\"\n[[outline]]\ntime = 2\nx = [1]\ny = [1]\n"
                        "[[outline]]\ntime = 1\nx = [1]\ny = [1]\n",
                        measured_outlines)
                .find("outlines in the order of their times"),
            std::string::npos);
  EXPECT_NE(message_for("enright_programs.toml",
                        "caption = \"x\"\ncolumns = [\"a\", \"b\"]\n[[program]]\ncells = [\"a\"]\n",
                        enright_programs)
                .find("allowed: 2 texts, one a column"),
            std::string::npos);
  EXPECT_NE(message_for("fujisawa_2011.toml", "source = \"x\"\nfaired_eror = 1\n", paper_figures)
                .find("did you mean \"faired_error\"?"),
            std::string::npos);
}

}  // namespace
}  // namespace kappaflow
