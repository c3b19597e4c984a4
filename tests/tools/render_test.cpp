#include <vtkImageData.h>
#include <vtkPNGReader.h>
#include <vtkSmartPointer.h>

#include "tests/tools/program.h"
#include "tests/tools/scratch.h"

namespace kappaflow {
namespace {

class Render : public Scratch {
 protected:
  void SetUp() override {
    Scratch::SetUp();
    const ProgramResult result =
        run_program({"run", KAPPAFLOW_SOURCE_DIR "/scenes/staircase-small.toml", "--out", folder.string(),
                     "--duration", "0.01", "--track", "total,curvature"});
    ASSERT_EQ(result.exit_code, 0) << result.err;
  }
  ProgramResult render(const std::vector<std::string>& more,
                       const std::vector<std::string>& environment = {}) const {
    std::vector<std::string> words{"render", folder.string(), "--out", (folder / "a.png").string()};
    words.insert(words.end(), more.begin(), more.end());
    return run_program(words, environment);
  }
};

TEST_F(Render, WithoutADisplayAndWithoutXvfbIsOneLine) {
  for (const char* environment : {"DISPLAY", "DISPLAY=:4711"}) {
    const ProgramResult result = render({}, {environment, "PATH=/nowhere"});
    EXPECT_EQ(result.exit_code, 5);
    EXPECT_EQ(
        result.err,
        "kappaflow: error: DISPLAY: there is no display to draw with, and no xvfb-run to make one; install "
        "xvfb\n");
  }
}

TEST_F(Render, WithoutADisplayAVirtualOneIsMade) {
  const ProgramResult result = render({}, {"DISPLAY"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(bytes_of(folder / "a.png").substr(0, 4), "\x89PNG");
}

TEST_F(Render, WrongChoicesAreOneLine) {
  EXPECT_EQ(render({"--frame", "7"}).err,
            "kappaflow: error: " + folder.string() + " has frames 0 to 1, not 7\n");
  EXPECT_EQ(render({"--methods", "material"}).err,
            "kappaflow: error: " + folder.string() + " has no surface tracked with \"material\"\n");
  EXPECT_EQ(render({"--out", (folder / "a.jpg").string()}).exit_code, 2);
}

TEST_F(Render, DrawsAPanelForEachMethod) {
  const ProgramResult result = render({"--frame", "0"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  auto reader = vtkSmartPointer<vtkPNGReader>::New();
  reader->SetFileName((folder / "a.png").c_str());
  reader->Update();
  vtkImageData& image = *reader->GetOutput();
  EXPECT_EQ(image.GetDimensions()[0], 1800);
  EXPECT_EQ(image.GetDimensions()[1], 800);
  // Both panels show the same frame 0 and differ in their titles only; neither is blank.
  int blue_left = 0, blue_right = 0;
  for (int y = 0; y < 700; ++y)
    for (int x = 0; x < 900; ++x) {
      const auto is_blue = [&](int column) {
        return image.GetScalarComponentAsDouble(column, y, 0, 2) >
               image.GetScalarComponentAsDouble(column, y, 0, 0) + 60;
      };
      blue_left += is_blue(x);
      blue_right += is_blue(x + 900);
    }
  EXPECT_GT(blue_left, 5000);
  EXPECT_EQ(blue_left, blue_right);
}

}  // namespace
}  // namespace kappaflow
