#include "tests/tools/program.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/stopwatch.h"
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

void wait_for(pid_t child, const Stop& stop, ProgramResult& result) {
  const Stopwatch watch;
  const auto is_time = [&] {
    return stop.when.empty() ? watch.seconds() >= stop.after : fs::exists(stop.when);
  };
  int status = 0;
  rusage usage{};
  bool ended = false;
  while (stop.signal != 0 && !ended && !is_time()) {
    usleep(1000);
    ended = wait4(child, &status, WNOHANG, &usage) != 0;
  }
  if (!ended) {
    const Stopwatch since_signal;
    if (stop.signal != 0) kill(child, stop.signal);
    wait4(child, &status, 0, &usage);
    result.seconds_to_end = since_signal.seconds();
  }
  result.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  result.peak_memory = static_cast<std::size_t>(usage.ru_maxrss) * 1024;
}

}  // namespace

ProgramResult run_program(const std::vector<std::string>& words, const std::vector<std::string>& environment,
                          const Stop& stop) {
  const std::string stem = testing::TempDir() + "kappaflow_program_" + std::to_string(getpid());
  const fs::path out = stem + ".out", err = stem + ".err";
  const pid_t child = fork();
  if (child == 0) become_program(words, environment, out, err);
  ProgramResult result;
  wait_for(child, stop, result);
  result.out = bytes_of(out);
  result.err = bytes_of(err);
  fs::remove(out);
  fs::remove(err);
  return result;
}

}  // namespace kappaflow
