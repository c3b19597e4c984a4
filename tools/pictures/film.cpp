#include "tools/pictures/film.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <system_error>

#include "core/errors.h"
#include "tools/io/files.h"
#include "tools/pictures/process.h"
#include "tools/runs/run_folder.h"

namespace kappaflow {

namespace fs = std::filesystem;

namespace {

bool is_picture(const fs::directory_entry& entry) {
  const std::string name = entry.path().filename().string();
  return name.starts_with("frame_") && (name.ends_with(".png") || name.ends_with(".png.tmp"));
}

bool may_take_pictures(const fs::path& folder) {
  if (!fs::exists(folder)) return !is_run_folder(folder);
  return fs::is_directory(folder) && std::ranges::all_of(fs::directory_iterator(folder), is_picture);
}

}  // namespace

fs::path pictures_folder(const fs::path& film) {
  fs::path folder = fs::path(film).replace_extension(),
           other = folder.parent_path() / ("frames-" + folder.filename().string());
  try {
    if (may_take_pictures(folder)) return folder;
    if (may_take_pictures(other)) return other;
  } catch (const fs::filesystem_error& error) {
    throw IoError(folder.string(), error.code().message());
  }
  throw InvalidInput(fmt::format("{} and {} hold other files than a film's pictures; name the film otherwise",
                                 folder.string(), other.string()));
}

fs::path film_picture(const fs::path& folder, int frame) {
  return folder / fmt::format("frame_{:04}.png", frame);
}

void make_film(const fs::path& film, const fs::path& folder, int frames, double frames_per_second) {
  const UnfinishedFile unfinished(fs::absolute(film).string() + ".tmp");
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
                                  unfinished.path().string()},
                                 folder);
  std::error_code error;
  if (status == 0) {
    fs::rename(unfinished.path(), film, error);
    if (error) throw IoError(film.string(), fmt::format("cannot be written ({})", error.message()));
    return;
  }
  const std::string reason = status == kProgramMissing ? "ffmpeg, which makes films, is not installed"
                                                       : fmt::format("ffmpeg failed with status {}", status);
  throw IoError(film.string(),
                fmt::format("{}; the pictures of all frames are in {}", reason, folder.string()));
}

}  // namespace kappaflow
