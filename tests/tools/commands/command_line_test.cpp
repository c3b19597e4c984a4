#include <fmt/format.h>

#include <algorithm>

#include "core/version.h"
#include "surface/motion/velocity_methods.h"
#include "tests/tools/program.h"
#include "tests/tools/scratch.h"

namespace kappaflow {
namespace {

const std::string kSmallScene = KAPPAFLOW_SOURCE_DIR "/scenes/staircase-small.toml";

const std::string kFrames = KAPPAFLOW_SOURCE_DIR "/tests/data/splishsplash/*.vtk";

class CommandLine : public Scratch {};

struct Mistake {
  std::vector<std::string> words;
  int exit_code;
  std::string message;  ///< part of the one line on stderr
};

void expect_one_line(const Mistake& mistake) {
  std::string shown = "kappaflow";
  for (const std::string& word : mistake.words) shown += " " + word;
  const ProgramResult result = run_program(mistake.words);
  EXPECT_EQ(result.exit_code, mistake.exit_code) << shown;
  EXPECT_EQ(result.out, "") << shown;
  EXPECT_EQ(std::ranges::count(result.err, '\n'), 1) << shown << "\n" << result.err;
  EXPECT_TRUE(result.err.starts_with("kappaflow: error: ")) << result.err;
  EXPECT_NE(result.err.find(mistake.message), std::string::npos) << shown << "\n" << result.err;
}

TEST_F(CommandLine, MistakesAreOneLineAndExitCodeTwo) {
  const std::vector<Mistake> mistakes{
      {{},
       2,
       "no command; commands are run, track, check, benchmark, probe, render, page, convert, experiment, "
       "compare; see "
       "kappaflow --help"},
      {{"frobnicate"}, 2, "unknown command \"frobnicate\"; see kappaflow --help"},
      {{"run"}, 2, "SCENE or --resume is required; see kappaflow run --help"},
      {{"run", "--resume"}, 2, "--resume: 1 required DIR missing"},
      {{"run", "--resume", "out", "--track", "total"}, 2, "--resume excludes --track"},
      {{"run", "--resume", "no/such/folder"}, 5, "no/such/folder: No such file or directory"},
      {{"run", "--resume", KAPPAFLOW_SOURCE_DIR}, 5, "holds no checkpoint to go on from"},
      {{"run", kSmallScene, "--threads", "0"},
       2,
       "--threads: found \"0\"; expected a whole number from 1 to 1024"},
      {{"run", kSmallScene, "--threads", "two"}, 2, "found \"two\""},
      {{"run", kSmallScene, "--threads", "1.5"}, 2, "found \"1.5\""},
      {{"run", kSmallScene, "--duration", "-1"}, 2, "expected a number of seconds above 0"},
      {{"run", kSmallScene, "--duration", "nan"}, 2, "expected a number of seconds above 0"},
      {{"run", kSmallScene, "--track", "total,bogus"}, 2, "found \"bogus\"; expected one of "},
      {{"run", kSmallScene, "--track", "total,total"}, 2, "\"total\" is named twice"},
      {{"run", kSmallScene, "--minimiser", "bfgs"}, 2, "unknown option \"--minimiser\""},
      {{"probe", "a.csv", "b.csv", "--threshold", "1", "--methods", "bogus"}, 2, "found \"bogus\""},
      {{"run", kSmallScene, "--colour"}, 2, "--colour"},
      {{"run", kSmallScene, "another"}, 2, "another"},
      {{"check"}, 2, "SCENE is required"},
      {{"probe", "a.csv", "b.csv"}, 2, "--threshold is required"},
      {{"probe", "a.csv", "b.csv", "--threshold", "high"}, 2, "found \"high\"; expected a number"},
      {{"render"}, 2, "DIR is required"},
      {{"render", "out", "--range", "1"}, 2, "--range: found \"1\"; expected LOW,HIGH"},
      {{"render", "out", "--up", "0,0,z"}, 2, "--up: found \"0,0,z\"; expected X,Y,Z"},
      {{"compare"}, 2, "DIR is required"},
      {{"compare", "/nowhere"}, 5, "/nowhere/run.json: cannot be read"},
      {{"track"}, 2, "FILES or --resume is required; see kappaflow track --help"},
      {{"track", "--resume", "out", "--velocity", "total"}, 2, "--resume excludes --velocity"},
      {{"track", "--resume", "out", "--backward"}, 2, "--resume excludes --backward"},
      {{"track", "--resume", KAPPAFLOW_SOURCE_DIR}, 5, "holds no checkpoint to go on from"},
      {{"track", "a_*.vtk", "--fps", "0"}, 2, "--fps: found \"0\"; expected a number above 0"},
      {{"track", "a_*.vtk", "--sigma", "wide"}, 2, "--sigma: found \"wide\"; expected a number above 0"},
      {{"track", "a_*.vtk", "--velocity", "bogus"}, 2, "found \"bogus\"; expected one of "},
      {{"track", "a_*.vtk", "--velocity", "total,total"}, 2, "\"total\" is named twice"},
      {{"track", "a_*.vtk", "--format", "stl"}, 2, "found \"stl\"; expected one of vtk, obj, ply, glb"},
      {{"track", "/nowhere/a_*.vtk"}, 5, "/nowhere/a_*.vtk: there is no such file"},
      {{"track", kFrames}, 2, "the files hold no times; say how many frames a second they are by --fps"},
  };
  for (const Mistake& mistake : mistakes) expect_one_line(mistake);
}

TEST_F(CommandLine, MistypedWordsNameTheLikelyOne) {
  const auto likely = [](std::vector<std::string> words, const std::string& message) {
    expect_one_line({std::move(words), 2, message});
  };
  likely({"rn"}, "unknown command \"rn\" (did you mean \"run\"?); see kappaflow --help");
  likely({"rn", kSmallScene, "--threads", "1"}, "unknown command \"rn\" (did you mean \"run\"?)");
  likely({"rn", "--help"}, "unknown command \"rn\" (did you mean \"run\"?)");
  likely({"help", "rendr"}, "unknown command \"rendr\" (did you mean \"render\"?)");
  likely({"--verison"}, "unknown option \"--verison\" (did you mean \"--version\"?); see kappaflow --help");
  likely({"run", kSmallScene, "--trak", "total"},
         "unknown option \"--trak\" (did you mean \"--track\"?); see kappaflow run --help");
  likely({"run", kSmallScene, "--tracks=total"}, "unknown option \"--tracks\" (did you mean \"--track\"?)");
  likely({"render", "out", "--color", "slip"}, "unknown option \"--color\" (did you mean \"--colour\"?)");
  // The option that is missing is the one that was mistyped.
  likely({"probe", "a.csv", "b.csv", "--threshhold", "1"}, "(did you mean \"--threshold\"?)");
  likely({"run", kSmallScene, "--formatting-of-files", "obj"}, "unknown option \"--formatting-of-files\";");
  likely({"--threads", "2", "check", kSmallScene}, "\"--threads\" stands before the command");
  likely({"run", kSmallScene, "--track", "regoinal"}, "(did you mean \"regional\"?)");
  likely({"track", "a_*.vtk", "--weights", "normalized"}, "(did you mean \"normalised\"?)");
  likely({"experiment", "motion", "--out", "nowhere"},
         "unknown experiment \"motion\"; experiments are all, validate, ");
  likely({"experiment", "motion", "--out", "nowhere"}, "validate-falling (did you mean \"motions\"?)");
}

TEST_F(CommandLine, HelpIsACommandToo) {
  EXPECT_EQ(run_program({"help"}).out, run_program({"--help"}).out);
  const ProgramResult help = run_program({"help", "run"});
  EXPECT_EQ(help.exit_code, 0);
  EXPECT_NE(help.out.find("--track"), std::string::npos);
  EXPECT_EQ(help.out, run_program({"run", "--help"}).out);
}

// The same points asked of the same particles, by both.
TEST_F(CommandLine, ProbeTakesKernels) {
  std::string cube = "x,y,z,vx,vy,vz,weight,sigma\n";
  for (int i = 0; i < 64; ++i) cube += fmt::format("{},{},{},1,0,0,1,2\n", i % 4, i / 4 % 4, i / 16);
  const std::string points = file("x.csv", "x,y,z\n1.5,1.5,3.5\n0.5,0.25,0\n").string();
  const auto answer = [&](const std::string& particles, const std::vector<std::string>& kernels) {
    std::vector<std::string> words{
        "probe", file("p.csv", particles).string(), points, "--threshold", "0.5", "--methods", "total"};
    words.insert(words.end(), kernels.begin(), kernels.end());
    const ProgramResult result = run_program(words);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return result.out;
  };
  const std::string round = answer(cube, {});
  EXPECT_EQ(answer(cube, {"--kernels", "round"}), round);
  const std::string anisotropic = answer(cube, {"--kernels", "anisotropic"});
  EXPECT_EQ(split(anisotropic, '\n')[0], split(round, '\n')[0]);
  for (const std::size_t row : {1, 2}) EXPECT_NE(split(anisotropic, '\n')[row], split(round, '\n')[row]);
  expect_one_line({{"probe", "p.csv", points, "--threshold", "0.5", "--kernels", "anisotropy"},
                   2,
                   "(did you mean \"anisotropic\"?)"});
}

// The columns of the result say which methods were understood.
TEST_F(CommandLine, ListsTakeCommasAndBlanks) {
  const std::string particles = file("p.csv", "x,y,z,vx,vy,vz,weight,sigma\n0,0,0,1,0,0,2,2\n").string(),
                    points = file("x.csv", "x,y,z\n1,0,0\n").string();
  const std::string expected =
      run_program({"probe", particles, points, "--threshold", "0.5", "--methods", "total,regional"}).out;
  ASSERT_NE(expected.find(",v_total_x,"), std::string::npos);
  ASSERT_NE(expected.find(",v_regional_x,"), std::string::npos);
  ASSERT_EQ(expected.find(",v_material_x,"), std::string::npos);
  for (const std::vector<std::string>& list :
       std::vector<std::vector<std::string>>{{"total, regional"},
                                             {"total regional"},
                                             {"total,", "regional"},
                                             {"total", ",", "regional"},
                                             {"total", "regional"},
                                             {"total", ",regional"},
                                             {" total,regional, "}}) {
    std::vector<std::string> words{"probe", "--threshold", "0.5", "--methods"};
    words.insert(words.end(), list.begin(), list.end());
    words.insert(words.end(), {particles, points});
    const ProgramResult result = run_program(words);
    EXPECT_EQ(result.out, expected) << fmt::format("{}: ", fmt::join(list, "|")) << result.err;
  }
  EXPECT_EQ(run_program({"probe", "--methods=total,", "regional", particles, points, "--threshold=0.5"}).out,
            expected);
  const auto refuses = [](std::vector<std::string> words, const std::string& message) {
    expect_one_line({std::move(words), 2, message});
  };
  refuses({"run", kSmallScene, "--track", "total,", "regoinal"}, "found \"regoinal\"; expected one of ");
  refuses({"run", kSmallScene, "--track", "total", "total"}, "\"total\" is named twice");
  refuses({"run", kSmallScene, "--track", ","}, "found \"\"; expected one of ");
  refuses({"run", kSmallScene, "--format", "obj", "ply", "--threads", "0"}, "found \"0\"; expected a whole");
  refuses({"benchmark", kSmallScene, "--threads", "1", "2", "--particles", "9", "1000"},
          "found \"9\"; expected a whole number from 100");
  refuses({"render", "out", "--view", "1,", "-1", "0", "0"}, "--view: found \"1,-1,0,0\"; expected X,Y,Z");
  refuses({"experiment", "fig3,", "fig44", "--out", "nowhere"}, "unknown experiment \"fig44\"");
  refuses({"experiment", "fig44 , fig3", "--out", "nowhere"}, "unknown experiment \"fig44\"");
}

TEST_F(CommandLine, WrongFilesAreOneLine) {
  const auto scene = file("odd.toml", "title = \"x\"\nspacin = 1\n");
  expect_one_line({{"check", scene.string()}, 2, scene.string() + ":2:1: "});
  expect_one_line({{"run", scene.string(), "--out", (folder / "r").string()}, 2, scene.string() + ":2:1: "});
  expect_one_line({{"check", (folder / "none.toml").string()}, 2, "none.toml"});
  expect_one_line({{"probe", (folder / "none.csv").string(), "b.csv", "--threshold", "1"}, 5, "none.csv"});
  expect_one_line({{"run", kSmallScene, "--out", "/proc/kappaflow"}, 5, "/proc/kappaflow"});
  expect_one_line({{"render", folder.string(), "--out", "a.png"}, 5, "run.json: cannot be read"});
  expect_one_line({{"experiment", "fig3", "--out", std::string(300, 'x')}, 5, "File name too long"});
  EXPECT_FALSE(std::filesystem::exists(folder / "r"));
}

TEST_F(CommandLine, RefusesAUsedFolder) {
  file("run.json", "{}");
  expect_one_line(
      {{"run", kSmallScene, "--out", folder.string()}, 2, "already holds a run; --force replaces it"});
}

TEST_F(CommandLine, EveryHelpHasAnExampleAndTheExitCodes) {
  for (const std::string command : {"run", "track", "check", "probe", "render", "compare"}) {
    const ProgramResult result = run_program({command, "--help"});
    EXPECT_EQ(result.exit_code, 0);
    EXPECT_EQ(result.err, "");
    EXPECT_NE(result.out.find("Example:\n"), std::string::npos) << command;
    EXPECT_NE(result.out.find("Exit codes:\n"), std::string::npos) << command;
  }
  const std::string help = run_program({"--help"}).out;
  for (const std::string command :
       {"run", "track", "check", "probe", "render", "compare", "Example:", "Exit codes:"})
    EXPECT_NE(help.find(command), std::string::npos);
  EXPECT_NE(run_program({"run", "--help"}).out.find("curvature-only"), std::string::npos)
      << "lists the methods";
}

/// The words at the beginnings of a help text's indented lines after `title`.
std::vector<std::string> listed(const std::string& help, const std::string& title) {
  std::vector<std::string> words;
  bool inside = false;
  for (const std::string& line : split(help, '\n')) {
    if (!line.starts_with(" ")) inside = line == title;
    const std::size_t end = line.find_first_of(" ,", 2);
    if (inside && line.starts_with("  ") && line.size() > 2 && line[2] != ' ')
      words.push_back(line.substr(2, end - 2));
  }
  return words;
}

TEST_F(CommandLine, TheDocumentsNameEveryOption) {
  const std::string page = bytes_of(KAPPAFLOW_SOURCE_DIR "/docs/commands.md");
  const std::vector<std::string> commands = listed(run_program({"--help"}).out, "Subcommands:");
  EXPECT_GE(commands.size(), 8u);
  for (const std::string& command : commands) {
    const std::size_t begin = page.find("\n## " + command + "\n"), end = page.find("\n## ", begin + 1);
    ASSERT_NE(begin, std::string::npos) << "docs/commands.md has no section on " << command;
    const std::string section = page.substr(begin, end - begin);
    const std::vector<std::string> options = listed(run_program({command, "--help"}).out, "Options:");
    EXPECT_GE(options.size(), 2u) << command;
    for (const std::string& option : options)
      EXPECT_TRUE(option == "-h" || section.find("`" + option) != std::string::npos)
          << "docs/commands.md does not say what " << command << " " << option << " is";
  }
}

TEST_F(CommandLine, VersionNamesTheBuild) {
  const ProgramResult result = run_program({"--version"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_TRUE(result.out.starts_with(std::string("kappaflow ") + kVersion + "\ncompiler ")) << result.out;
  EXPECT_NE(result.out.find("VTK 9."), std::string::npos);
  EXPECT_NE(result.out.find("Eigen 3."), std::string::npos);
}

TEST_F(CommandLine, CheckSaysWhatTheSceneCosts) {
  const ProgramResult result = run_program({"check", kSmallScene, "--threads", "1"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.err, "");
  for (const char* part :
       {"particles 1000\n", "boundary particles ", " on 1 thread\n", "stairs, 5 steps", "methods "})
    EXPECT_NE(result.out.find(part), std::string::npos) << part << "\n" << result.out;
}

TEST_F(CommandLine, TrackSaysWhatItFoundAndRenderDrawsIt) {
  const std::string out = (folder / "tracked").string();
  const ProgramResult result = run_program({"track", kFrames, "--fps", "30", "--velocity", "regional",
                                            "--format", "obj", "--threads", "1", "--out", out});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.err, "");
  for (const char* part :
       {"ParticleData_Fluid: 3 files", "2160 particles\n", "matched by id (\"id\")",
        "velocities from \"velocity\"", "velocities and displacements fit 25 frames a second, not 30",
        "spacing 0.06", "(measured)", "velocity regional\n"})
    EXPECT_NE(result.out.find(part), std::string::npos) << part << "\n" << result.out;
  EXPECT_TRUE(std::filesystem::exists(folder / "tracked/surface-regional/surface_0002.obj"));
  EXPECT_FALSE(std::filesystem::exists(folder / "tracked/surface-regional/surface_0002.ply"));
  expect_one_line({{"track", kFrames, "--fps", "25", "--out", out},
                   2,
                   "already holds a run; kappaflow track --resume goes on with it, --force replaces it"});
  const ProgramResult drawn = run_program({"render", out, "--out", (folder / "a.png").string()});
  EXPECT_EQ(drawn.exit_code, 0) << drawn.err;
  EXPECT_EQ(bytes_of(folder / "a.png").substr(0, 4), "\x89PNG");
}

TEST_F(CommandLine, ProbePrintsATable) {
  const auto particles = file("particles.csv", "x,y,z,vx,vy,vz,weight,sigma\n0,0,0,1,0,0,1,1\n");
  const auto points = file("points.csv", "x,y,z\n0.5,0,0\n");
  const ProgramResult result = run_program(
      {"probe", particles.string(), points.string(), "--threshold", "0.25", "--methods", "total,material"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_TRUE(result.out.starts_with("x,y,z,f,f_x,")) << result.out;
  EXPECT_NE(result.out.find(",v_total_x,v_total_y,v_total_z,confidence_total,v_material_x,"),
            std::string::npos);
  EXPECT_NE(result.out.find("\n0.5,0,0,0.171875,"), std::string::npos) << "0.75^3 - 0.25";

  const std::string all =
      run_program({"probe", particles.string(), points.string(), "--threshold", "0.25"}).out;
  for (const VelocityMethod& method : velocity_methods())
    EXPECT_NE(all.find(fmt::format(",confidence_{}", method.name)), std::string::npos) << method.name;
}

}  // namespace
}  // namespace kappaflow
