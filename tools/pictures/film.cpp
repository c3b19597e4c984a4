#include "tools/pictures/film.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

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

/// How ffmpeg makes a film of a kind.
struct Coding {
  std::string_view ending;
  std::vector<std::string> words;
};

const std::vector<Coding>& codings() {
  static const std::vector<Coding> list{
      // Browsers play yuv420p alone, which has even sizes; with faststart they begin before they have all of
      // it.
      {".mp4",
       {"-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2:color=white", "-c:v", "libx264", "-crf", "18", "-pix_fmt",
        "yuv420p", "-movflags", "+faststart", "-f", "mp4"}},
      // The 256 colours that the film itself has most; what stands still costs nothing.
      {".gif",
       {"-vf", "split[a][b];[a]palettegen[palette];[b][palette]paletteuse=dither=none:diff_mode=rectangle",
        "-loop", "0", "-f", "gif"}},
      {".webp",
       {"-c:v", "libwebp_anim", "-quality", "75", "-compression_level", "6", "-loop", "0", "-f", "webp"}}};
  return list;
}

const Coding* coding_of(const fs::path& film) {
  const std::string ending = film.extension().string();
  const auto found = std::ranges::find(codings(), ending, &Coding::ending);
  return found == codings().end() ? nullptr : &*found;
}

/// Run in the pictures' folder, because a % in its name would be taken for a number's place.
std::vector<std::string> ffmpeg_command(const Coding& coding, const FilmFrames& frames, const fs::path& out) {
  std::vector<std::string> words{"ffmpeg",
                                 "-nostdin",
                                 "-loglevel",
                                 "error",
                                 "-y",
                                 "-framerate",
                                 fmt::format("{}", frames.per_second),
                                 "-start_number",
                                 fmt::format("{}", frames.first),
                                 "-i",
                                 "frame_%04d.png",
                                 "-frames:v",
                                 fmt::format("{}", frames.count)};
  words.insert(words.end(), coding.words.begin(), coding.words.end());
  words.push_back(out.string());
  return words;
}

}  // namespace

bool is_film(const fs::path& file) {
  return coding_of(file) != nullptr;
}

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

void remove_other_pictures(const fs::path& folder, int first, int last) {
  std::set<fs::path> ours;
  for (int frame = first; frame <= last; ++frame) ours.insert(film_picture(folder, frame));
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error))
    if (!ours.contains(entry.path())) fs::remove(entry.path(), error);
  if (error) throw IoError(folder.string(), error.message());
}

void make_film(const fs::path& film, const fs::path& folder, const FilmFrames& frames) {
  const UnfinishedFile unfinished(fs::absolute(film).string() + ".tmp");
  const int status = run_command(ffmpeg_command(*coding_of(film), frames, unfinished.path()), folder);
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
