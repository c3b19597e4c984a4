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

/// Makes a film (.mp4, H.264) of the pictures film_picture(folder, 0) ... film_picture(folder, frames - 1).
/// The file is complete or absent. Throws IoError, e.g. where ffmpeg is not installed.
void make_film(const std::filesystem::path& film, const std::filesystem::path& folder, int frames,
               double frames_per_second);

}  // namespace kappaflow
