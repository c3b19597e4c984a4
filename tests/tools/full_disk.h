// A full disk, as far as one program can tell.
#pragma once

#include <sys/resource.h>

#include <csignal>

namespace kappaflow {

/// While it lives, no file of this process or one that it starts may grow beyond `bytes`: writing fails as it
/// does on a full disk.
class FullDisk {
 public:
  explicit FullDisk(rlim_t bytes) {
    getrlimit(RLIMIT_FSIZE, &previous_);
    rlimit limit = previous_;
    limit.rlim_cur = bytes;
    setrlimit(RLIMIT_FSIZE, &limit);
    previous_handler_ = std::signal(SIGXFSZ, SIG_IGN);
  }
  ~FullDisk() {
    setrlimit(RLIMIT_FSIZE, &previous_);
    std::signal(SIGXFSZ, previous_handler_);
  }
  FullDisk(const FullDisk&) = delete;
  FullDisk& operator=(const FullDisk&) = delete;

 private:
  rlimit previous_;
  void (*previous_handler_)(int);
};

}  // namespace kappaflow
