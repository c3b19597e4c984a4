#include <cstdlib>

#include "tests/tools/everything_scene.h"
#include "tests/tools/image.h"
#include "tests/tools/program.h"
#include "tests/tools/scratch.h"

namespace kappaflow {
namespace {

/// A page's script that counts what goes wrong, before any other.
constexpr const char* kProblems =
    "<head>\n<script>const problems = [];"
    "addEventListener('error', event => problems.push(`error: ${event.message}`));"
    "addEventListener('unhandledrejection', event => problems.push(`rejected: ${event.reason}`));"
    "for (const kind of ['error', 'warn']) console[kind] = (...words) => problems.push(`console: ${words}`);"
    "</script>";

void replace(std::string& text, const std::string& what, const std::string& with) {
  const std::size_t at = text.find(what);
  ASSERT_NE(at, std::string::npos) << what;
  text.replace(at, what.size(), with);
}

class Page : public Scratch {
 protected:
  static void SetUpTestSuite() {
    run_folder = std::filesystem::path(testing::TempDir()) / ("kappaflow_page_" + std::to_string(getpid()));
    const ProgramResult result =
        run_program({"run", KAPPAFLOW_SOURCE_DIR "/scenes/staircase-small.toml", "--out", run_folder.string(),
                     "--duration", "0.2", "--track", "total,curvature,regional"});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    ASSERT_EQ(run_program({"page", run_folder.string()}).exit_code, 0);
  }
  static void TearDownTestSuite() { std::filesystem::remove_all(run_folder); }

  /// What page_check.js has to say of a page in Chromium: a list of failures; empty where there was no
  /// answer.
  std::string verdict(std::string page) const {
    replace(page, "<head>", kProblems);
    const std::string check = bytes_of(KAPPAFLOW_SOURCE_DIR "/tests/tools/commands/page_check.js");
    replace(page, "</body>", "<script>\n" + check + "</script>\n</body>");
    const std::string name = file("checked.html", page).string(), dom = (folder / "dom.html").string();
    const std::string command =
        "timeout 120 chromium --headless --no-sandbox --use-angle=swiftshader --enable-unsafe-swiftshader "
        "--hide-scrollbars --window-size=1200,800 --enable-logging=stderr --user-data-dir='" +
        (folder / "profile").string() + "' --screenshot='" + (folder / "page.png").string() +
        "' --dump-dom 'file://" + name + "' >'" + dom + "' 2>'" + (folder / "log").string() + "'";
    EXPECT_EQ(std::system(command.c_str()), 0) << bytes_of(folder / "log");
    const std::string text = bytes_of(dom), attribute = "data-failures=\"";
    const std::size_t begin = text.find(attribute);
    if (begin == std::string::npos) return "";
    return text.substr(begin + attribute.size(),
                       text.find('"', begin + attribute.size()) - begin - attribute.size());
  }
  static bool has_chromium() { return std::system("command -v chromium >/dev/null") == 0; }

  static std::filesystem::path run_folder;
};
std::filesystem::path Page::run_folder;

TEST_F(Page, PlaysTurnsAndSwitchesInChromium) {
  if (!has_chromium()) GTEST_SKIP() << "chromium is not installed";
  EXPECT_EQ(verdict(bytes_of(run_folder / "page.html")), "[]");
  EXPECT_EQ(bytes_of(folder / "log").find("CONSOLE"), std::string::npos) << bytes_of(folder / "log");
  EXPECT_GT(blue_share(Image(folder / "page.png")), 0.03) << "what a person sees";
}

TEST_F(Page, TheCheckFindsWhatIsBroken) {
  if (!has_chromium()) GTEST_SKIP() << "chromium is not installed";
  const std::string whole = bytes_of(run_folder / "page.html");
  struct Fault {
    const char *what, *with, *found;
  };
  for (const auto& [what, with, found] :
       {Fault{"gl.drawElements(gl.TRIANGLES", "String(gl.TRIANGLES", "blank: total"},
        Fault{"advance(passed / 1000)", "advance(0)", "playing does not advance"},
        Fault{"state.colour = colour;", "", "switching changes no pixels"},
        Fault{"showOrigin();\n", "console.error('broken');\n", "console: broken"}}) {
    std::string broken = whole;
    replace(broken, what, with);
    const std::string failures = verdict(broken);
    EXPECT_NE(failures.find(found), std::string::npos) << failures;
  }
}

TEST_F(Page, NeedsNothingElse) {
  const std::string page = bytes_of(run_folder / "page.html");
  EXPECT_NE(page.find("default-src 'none'"), std::string::npos) << "the browser loads nothing";
  for (const char* link : {" src=", "href=", "@import", "url("})
    EXPECT_EQ(page.find(link), std::string::npos) << link;
}

TEST_F(Page, ShowsWhenLiquidCame) {
  const std::string colour = "\"array\":\"emission_time\"";
  EXPECT_EQ(bytes_of(run_folder / "page.html").find(colour), std::string::npos) << "nothing flows in";
  const std::string out = (folder / "fed").string();
  ASSERT_EQ(run_program({"run", file("everything.toml", kEverythingScene).string(), "--out", out,
                         "--duration", "0.1", "--track", "material"})
                .exit_code,
            0);
  const ProgramResult result = run_program({"page", out});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const std::string page = bytes_of(out + "/page.html");
  const std::size_t begin = page.find(colour), range = page.find("\"range\":[", begin);
  ASSERT_NE(begin, std::string::npos);
  EXPECT_EQ(page.substr(range, page.find(']', range) - range), "\"range\":[0.0,0.1")
      << "from beginning to end";
  EXPECT_EQ(page.find("\"array\":\"material_slip\""), std::string::npos) << "rounding, of material alone";
}

TEST_F(Page, SaysWhereItIs) {
  const std::string out = (folder / "a b.html").string();
  const ProgramResult result =
      run_program({"page", run_folder.string(), "--methods", "regional", "--out", out});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.out.find(out + ": 6 frames of regional, 0."), 0u) << result.out;
  EXPECT_NE(result.out.find("\nOpen it in a browser: file://" + folder.string() + "/a%20b.html\n"),
            std::string::npos)
      << result.out;
  EXPECT_LT(std::filesystem::file_size(out), std::filesystem::file_size(run_folder / "page.html"));
}

TEST_F(Page, MistakesAreOneLine) {
  const auto expect_refused = [&](const std::vector<std::string>& words, int code, const std::string& error) {
    const ProgramResult result = run_program(words);
    EXPECT_EQ(result.exit_code, code);
    EXPECT_EQ(result.err, "kappaflow: error: " + error + "\n");
  };
  const std::string run = run_folder.string(), out = (folder / "page.html").string();
  expect_refused({"page", run, "--methods", "material"}, 2,
                 run + " has no surface tracked with \"material\"");
  expect_refused({"page", run, "--methods", "total,total"}, 2, "--methods: \"total\" is named twice");
  expect_refused({"page", run, "--out", "page.htm"}, 2,
                 "found \"page.htm\"; expected a file name that ends in .html");
  expect_refused({"page", folder.string()}, 5,
                 (folder / "run.json").string() + ": cannot be read (No such file or directory)");
  EXPECT_EQ(run_program({"page", run, "--out", (folder / "none" / "page.html").string()}).exit_code, 5);
}

}  // namespace
}  // namespace kappaflow
