#include "tests/tools/program.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/tools/scratch.h"

namespace kappaflow {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void become_program(std::vector<std::string> words, const std::vector<std::string>& environment,
                                 const fs::path& out, const fs::path& err) {
  for (const std::string& entry : environment) {
    const std::size_t equals = entry.find('=');
    if (equals == std::string::npos)
      unsetenv(entry.c_str());
    else
      setenv(entry.substr(0, equals).c_str(), entry.c_str() + equals + 1, 1);
  }
  dup2(open(out.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600), STDOUT_FILENO);
  dup2(open(err.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600), STDERR_FILENO);
  std::string program = KAPPAFLOW_PROGRAM;
  std::vector<char*> arguments{program.data()};
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  execv(KAPPAFLOW_PROGRAM, arguments.data());
  _exit(127);
}

int wait_for(pid_t child, const fs::path& interrupt_when) {
  int status = 0;
  if (!interrupt_when.empty()) {
    while (!fs::exists(interrupt_when) && waitpid(child, &status, WNOHANG) == 0) usleep(1000);
    kill(child, SIGINT);
  }
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

}  // namespace

ProgramResult run_program(const std::vector<std::string>& words, const std::vector<std::string>& environment,
                          const fs::path& interrupt_when) {
  const std::string stem = testing::TempDir() + "kappaflow_program_" + std::to_string(getpid());
  const fs::path out = stem + ".out", err = stem + ".err";
  const pid_t child = fork();
  if (child == 0) become_program(words, environment, out, err);
  ProgramResult result;
  result.exit_code = wait_for(child, interrupt_when);
  result.out = bytes_of(out);
  result.err = bytes_of(err);
  fs::remove(out);
  fs::remove(err);
  return result;
}

}  // namespace kappaflow
