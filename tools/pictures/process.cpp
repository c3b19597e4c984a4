#include "tools/pictures/process.h"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <system_error>

#include "core/errors.h"
#include "core/stopwatch.h"

namespace kappaflow {
namespace {

constexpr double kSecondsToEnd = 0.2;

/// In the child of a program with several threads: nothing but system calls.
[[noreturn]] void become(char** argv, const ChildOptions& options, const sigset_t& no_signals, pid_t parent) {
  prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (getppid() != parent) _exit(kProgramMissing);  // it has ended before
  setpgid(0, 0);
  sigprocmask(SIG_SETMASK, &no_signals, nullptr);
  const int nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC);
  dup2(nowhere, STDOUT_FILENO);
  if (options.silent) dup2(nowhere, STDERR_FILENO);
  if (options.descriptor >= 0) fcntl(options.descriptor, F_SETFD, 0);
  if (chdir(options.folder.c_str()) == 0) execvp(argv[0], argv);
  _exit(kProgramMissing);
}

}  // namespace

pid_t start_program(std::vector<std::string> words, const ChildOptions& options) {
  std::vector<char*> argv;
  argv.reserve(words.size() + 1);
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  sigset_t no_signals;
  sigemptyset(&no_signals);
  const pid_t parent = getpid();
  const pid_t child = fork();
  if (child < 0) throw IoError(words[0], std::generic_category().message(errno));
  if (child == 0) become(argv.data(), options, no_signals, parent);
  return child;
}

int wait_for_program(pid_t program) {
  int status = 0;
  while (waitpid(program, &status, 0) < 0 && errno == EINTR) {
  }
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

int run_command(std::vector<std::string> words, const std::filesystem::path& folder) {
  return wait_for_program(start_program(std::move(words), {.folder = folder}));
}

void end_program(pid_t program) {
  kill(program, SIGTERM);
  for (const Stopwatch watch; watch.seconds() < kSecondsToEnd;) {
    if (waitpid(program, nullptr, WNOHANG) != 0) return;
    usleep(1000);
  }
}

}  // namespace kappaflow
