#include "tools/virtual_display.h"

#include <unistd.h>

#include <cstdlib>
#include <string>
#include <vector>

#include "core/errors.h"
#include "tools/display.h"

namespace kappaflow {
namespace {

// Set for the program that xvfb-run starts, so that a virtual display that does not work is not tried twice.
constexpr const char* kUnderXvfb = "KAPPAFLOW_UNDER_XVFB";

}  // namespace

void ensure_display(char** argv) {
  if (has_display()) return;
  if (std::getenv(kUnderXvfb) == nullptr) {
    setenv(kUnderXvfb, "1", 1);
    std::string xvfb = "xvfb-run", automatic = "-a";
    std::vector<char*> words{xvfb.data(), automatic.data()};
    for (char** word = argv; *word != nullptr; ++word) words.push_back(*word);
    words.push_back(nullptr);
    execvp(words[0], words.data());
  }
  throw IoError("DISPLAY", "there is no display to draw with, and no xvfb-run to make one; install xvfb");
}

}  // namespace kappaflow
