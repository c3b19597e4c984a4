#include "tools/pictures/virtual_display.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <atomic>
#include <cstdlib>
#include <string>

#include "core/errors.h"
#include "tools/io/files.h"
#include "tools/pictures/display.h"
#include "tools/pictures/process.h"
#include "tools/runs/interrupt.h"
#include "tools/runs/progress.h"

namespace kappaflow {
namespace {

std::atomic<pid_t> server{0};  // 0: none; for whoever ends the program

void end_server() {
  if (const pid_t ended = server.exchange(0); ended != 0) end_program(ended);
}

void clean_up() {
  draw_status_line("");
  remove_unfinished_files();
  wait_without_display();
  end_server();
}

/// The number that the server writes once clients can come; empty where it ends before.
std::string read_line(int descriptor) {
  std::string line;
  for (char c = 0; read(descriptor, &c, 1) == 1 && c != '\n';) line += c;
  return line;
}

/// Returns the name of its display; empty where it does not start.
std::string start_server() {
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) return "";
  server = start_program(
      {"Xvfb", "-displayfd", fmt::format("{}", ends[1]), "-screen", "0", "1280x1024x24", "-nolisten", "tcp"},
      {.descriptor = ends[1], .silent = true});
  close(ends[1]);
  const std::string number = read_line(ends[0]);
  close(ends[0]);
  return number.empty() ? "" : ":" + number;
}

}  // namespace

VirtualDisplay::VirtualDisplay() {
  end_at_once_on_signals(clean_up);
  if (has_display()) return;
  const std::string name = start_server();
  setenv("DISPLAY", name.c_str(), 1);
  // Mesa keeps it by a thread of lowest priority, which on a busy machine takes seconds to end.
  setenv("MESA_SHADER_CACHE_DISABLE", "true", 0);
  if (!name.empty() && has_display()) return;
  end_server();
  throw IoError("DISPLAY", "there is no display to draw with, and no Xvfb to make one; install xvfb");
}

VirtualDisplay::~VirtualDisplay() {
  end_server();
}

}  // namespace kappaflow
