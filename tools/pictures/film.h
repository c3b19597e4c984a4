// Films from pictures, by ffmpeg.
#pragma once

#include <filesystem>

namespace kappaflow {

/// Where the pictures of a film are: in the folder of its name without the ending, or where that holds other
/// files or is a run's, in the one that has "frames-" before it. Throws InvalidInput where that one holds
/// others too, IoError where it cannot be looked at.
std::filesystem::path pictures_folder(const std::filesystem::path& film);

/// The picture of a frame in the folder of a film's pictures.
std::filesystem::path film_picture(const std::filesystem::path& folder, int frame);

/// Removes the pictures of other frames from the folder, such as those of a longer film before. Throws
/// IoError.
void remove_other_pictures(const std::filesystem::path& folder, int first, int last);

/// Whether the file's name is that of a film: .mp4 (H.264, which browsers play), or .gif or .webp, which run
/// for ever in a page.
bool is_film(const std::filesystem::path& file);

/// The frames of a film.
struct FilmFrames {
  int first, count;
  double per_second;
};

/// Makes a film of the pictures film_picture(folder, first) ... film_picture(folder, first + count - 1). The
/// file is complete or absent. Throws IoError, e.g. where ffmpeg is not installed. Precondition:
/// is_film(film).
void make_film(const std::filesystem::path& film, const std::filesystem::path& folder,
               const FilmFrames& frames);

}  // namespace kappaflow
