// How often files are opened.
#pragma once

#include <sys/inotify.h>
#include <unistd.h>

#include <array>
#include <cstring>
#include <filesystem>

namespace kappaflow::test {

/// Counts, by what the system says, how often a file is opened while this lives.
class OpenCounter {
 public:
  // Closing is watched too: the system joins equal events that follow each other.
  explicit OpenCounter(const std::filesystem::path& file)
      : events_(inotify_init1(IN_NONBLOCK)),
        watches_(inotify_add_watch(events_, file.c_str(), IN_OPEN | IN_CLOSE) >= 0) {}
  ~OpenCounter() { close(events_); }
  OpenCounter(const OpenCounter&) = delete;
  OpenCounter& operator=(const OpenCounter&) = delete;

  /// False where the system does not say.
  bool works() const { return watches_; }
  /// Since the last call.
  int count() {
    int opened = 0;
    std::array<char, 4096> buffer;
    for (ssize_t size = 0; (size = read(events_, buffer.data(), buffer.size())) > 0;)
      for (ssize_t at = 0; at < size;) {
        inotify_event event;
        std::memcpy(&event, buffer.data() + at, sizeof event);
        opened += (event.mask & IN_OPEN) != 0;
        at += static_cast<ssize_t>(sizeof event + event.len);
      }
    return opened;
  }

 private:
  int events_;
  bool watches_;
};

}  // namespace kappaflow::test
