#include "core/suggestion.h"

#include <gtest/gtest.h>

#include <vector>

namespace kappaflow {
namespace {

TEST(Suggestion, IsTheNameThatDiffersLeast) {
  const std::vector<std::string_view> names{"run", "render", "track", "check"};
  EXPECT_EQ(suggestion("rn", names), " (did you mean \"run\"?)");
  EXPECT_EQ(suggestion("tarck", names), " (did you mean \"track\"?)");
  EXPECT_EQ(suggestion("rendering", names), " (did you mean \"render\"?)") << "three of nine";
  EXPECT_EQ(suggestion("frobnicate", names), "");
  EXPECT_EQ(suggestion("", names), "");
}

TEST(Suggestion, NamesAllThatAreAsNearUnlessTheyAreMany) {
  const std::vector<std::string_view> figures{"fig3", "fig4", "fig5", "fig7", "body"};
  EXPECT_EQ(suggestion("fig6", figures), "");
  EXPECT_EQ(suggestion("fig44", figures), " (did you mean \"fig4\"?)");
  const std::vector<std::string_view> integrators{"euler", "rk2", "rk4"};
  EXPECT_EQ(suggestion("rk3", integrators), " (did you mean \"rk2\" or \"rk4\"?)");
}

}  // namespace
}  // namespace kappaflow
