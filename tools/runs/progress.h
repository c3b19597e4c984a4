// One line on the terminal that says how far a run is.
#pragma once

#include <string>
#include <utility>

#include "tools/runs/timings.h"

namespace kappaflow {

/// Draws `text` over the line that the terminal's cursor is in, cut to its width; "" wipes the line. Does
/// nothing where stderr is no terminal.
void draw_status_line(const std::string& text);

/// One line on stderr, drawn at most five times a second, and only when that is a terminal; wipes itself out
/// at the end.
class StatusLine {
 public:
  explicit StatusLine(bool enabled) : enabled_(enabled) {}
  ~StatusLine();
  StatusLine(const StatusLine&) = delete;
  StatusLine& operator=(const StatusLine&) = delete;

  /// Whether show() would draw: for texts that cost something.
  bool is_due() const;
  void show(const std::string& text);
  double seconds() const { return watch_.seconds(); }  ///< since the line was made

 private:
  bool enabled_;
  Stopwatch watch_;
  double last_drawn_ = -1;  // [s] of watch_
};

/// How far work is that consists of so many pieces of about the same size, on such a line.
class WorkProgress {
 public:
  WorkProgress(std::string what, int count, bool enabled = true)
      : what_(std::move(what)), count_(count), line_(enabled) {}

  /// Call before each piece; done: how many are.
  void show(int done);

 private:
  std::string what_;
  int count_;
  StatusLine line_;
};

/// The line itself. elapsed: wall time so far [s].
std::string work_line(const std::string& what, int done, int count, double elapsed);

/// How far a run is, on such a line.
class Progress {
 public:
  /// From time `start` to `end` [s]; frames: number of the last one.
  Progress(double start, double end, int frames, bool enabled);

  /// Call after each step that worked towards `frame`. detail: what else there is to say of it.
  void show(double time, int frame, const std::string& detail);

 private:
  double start_, end_;
  int frames_;
  StatusLine line_;
  std::size_t steps_ = 0;
};

/// The line itself. done: share of the whole, in [0, 1]; elapsed: wall time so far [s].
std::string progress_line(double done, double time, int frame, int frames, std::size_t steps, double elapsed,
                          const std::string& detail);

}  // namespace kappaflow
