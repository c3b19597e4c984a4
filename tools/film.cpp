#include "tools/film.h"

#include <fmt/format.h>

#include <system_error>

#include "core/errors.h"
#include "tools/process.h"

namespace kappaflow {

namespace fs = std::filesystem;

fs::path film_picture(const fs::path& folder, int frame) {
  return folder / fmt::format("frame_{:04}.png", frame);
}

void make_film(const fs::path& film, const fs::path& folder, int frames, double frames_per_second) {
  const fs::path unfinished = fs::absolute(film).string() + ".tmp";
  // Run in the pictures' folder, because a % in its name would be taken for a number's place.
  const int status = run_command({"ffmpeg",
                                  "-nostdin",
                                  "-loglevel",
                                  "error",
                                  "-y",
                                  "-framerate",
                                  fmt::format("{}", frames_per_second),
                                  "-i",
                                  "frame_%04d.png",
                                  "-frames:v",
                                  fmt::format("{}", frames),
                                  "-c:v",
                                  "libx264",
                                  "-crf",
                                  "18",
                                  "-pix_fmt",
                                  "yuv420p",
                                  "-movflags",
                                  "+faststart",
                                  "-f",
                                  "mp4",
                                  unfinished.string()},
                                 folder);
  std::error_code error;
  if (status == 0) {
    fs::rename(unfinished, film, error);
    if (error) throw IoError(film.string(), fmt::format("cannot be written ({})", error.message()));
    return;
  }
  fs::remove(unfinished, error);  // the first failure is the one to report
  const std::string reason = status == kProgramMissing ? "ffmpeg, which makes films, is not installed"
                                                       : fmt::format("ffmpeg failed with status {}", status);
  throw IoError(film.string(),
                fmt::format("{}; the pictures of all frames are in {}", reason, folder.string()));
}

}  // namespace kappaflow
