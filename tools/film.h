// Films from pictures, by ffmpeg.
#pragma once

#include <filesystem>

namespace kappaflow {

/// The picture of a frame in the folder of a film's pictures.
std::filesystem::path film_picture(const std::filesystem::path& folder, int frame);

/// Makes a film (.mp4, H.264) of the pictures film_picture(folder, 0) ... film_picture(folder, frames - 1).
/// The file is complete or absent. Throws IoError, e.g. where ffmpeg is not installed.
void make_film(const std::filesystem::path& film, const std::filesystem::path& folder, int frames,
               double frames_per_second);

}  // namespace kappaflow
