#include "tools/runs/progress.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>

namespace kappaflow {
namespace {

constexpr double kRedrawSeconds = 0.2;
constexpr int kBarWidth = 12;
constexpr const char* kWipeLine = "\r\033[K";

// A longer line would wrap, and wiping it would leave its first part behind.
std::size_t terminal_width() {
  winsize size{};
  const bool known = ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0;
  return known ? size.ws_col : 80;
}

std::string clock_time(double seconds) {
  const long whole = std::lround(std::min(seconds, 359999.0));
  return whole < 3600 ? fmt::format("{}:{:02}", whole / 60, whole % 60)
                      : fmt::format("{}:{:02}:{:02}", whole / 3600, whole / 60 % 60, whole % 60);
}

}  // namespace

void draw_status_line(const std::string& text) {
  if (isatty(STDERR_FILENO) != 1) return;
  fmt::print(stderr, "{}{}", kWipeLine, text.substr(0, terminal_width()));
  std::fflush(stderr);
}

std::string work_line(const std::string& what, int done, int count, double elapsed) {
  const std::string left = done > 0 ? clock_time(elapsed * (count - done) / done) : "?";
  return fmt::format("{} {} of {}  {} left", what, done + 1, count, left);
}

std::string progress_line(double done, double time, int frame, int frames, std::size_t steps, double elapsed,
                          const std::string& detail) {
  const auto filled = static_cast<std::size_t>(std::lround(done * kBarWidth));
  const std::string bar = std::string(filled, '#') + std::string(kBarWidth - filled, '-');
  const std::string left = done > 0 ? clock_time(elapsed * (1 - done) / done) : "?";
  return fmt::format("[{}] {:.3f} s  frame {}/{}  {:.1f} steps/s  {}  {} left", bar, time, frame, frames,
                     static_cast<double>(steps) / std::max(elapsed, 1e-9), detail, left);
}

StatusLine::~StatusLine() {
  if (enabled_) draw_status_line("");
}

bool StatusLine::is_due() const {
  return enabled_ && (last_drawn_ < 0 || watch_.seconds() - last_drawn_ >= kRedrawSeconds);
}

void StatusLine::show(const std::string& text) {
  if (!is_due()) return;
  last_drawn_ = watch_.seconds();
  draw_status_line(text);
}

void WorkProgress::show(int done) {
  if (line_.is_due()) line_.show(work_line(what_, done, count_, line_.seconds()));
}

Progress::Progress(double start, double end, int frames, bool enabled)
    : start_(start), end_(end), frames_(frames), line_(enabled) {}

void Progress::show(double time, int frame, const std::string& detail) {
  ++steps_;
  if (!line_.is_due()) return;
  const double done = std::clamp((time - start_) / (end_ - start_), 0.0, 1.0);
  line_.show(progress_line(done, time, frame, frames_, steps_, line_.seconds(), detail));
}

}  // namespace kappaflow
