// The syntax of USD's text files (.usda), as far as animated scenes need it.
//
// A scene is written without a USD library as a small root with value clips, a manifest, and a file a frame:
// https://openusd.org/release/api/_usd__page__value_clips.html
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "core/types.h"

namespace kappaflow {

/// What all files of a scene share.
struct UsdStage {
  double frames_per_second = 25;  ///< simulated; time codes are numbers of frames
  bool z_up = false;              ///< instead of y
  Vec3 origin = Vec3::Zero();     ///< that positions are from: the translation of /World [m]
};

/// An attribute whose values differ from frame to frame.
struct UsdAttribute {
  std::string_view type, name;
  std::string_view interpolation = {};  ///< empty: none
};

/// The first lines of a file. frames: how many there are, from 0. sublayers: files to compose, if any.
std::string usd_header(const UsdStage& stage, int frames, std::span<const std::string> sublayers = {});

/// Declares attributes without values, a line or three each, indented by that many blanks.
std::string usd_declarations(std::span<const UsdAttribute> attributes, int indent);

/// `prims`, which are indented by four, in /World.
std::string usd_world(const UsdStage& stage, const std::string& prims);

/// The manifest of value clips whose prim is `prim`: says which attributes vary.
std::string usd_manifest(std::string_view prim, std::span<const UsdAttribute> attributes);

/// The metadata `clips` of a prim, as lines indented by eight. stem: of the clips' files, which are
/// STEM.0000.usda and so on; manifest: a file; prim: in the clips. Names are relative to the root's folder.
std::string usd_clips(const std::string& stem, const std::string& manifest, std::string_view prim,
                      int frames);

/// A name that USD allows for a prim: letters, digits, underscores.
std::string usd_name(std::string_view name);

/// Lists as [1,2] or, of several components, [(1,2,3),(4,5,6)]; real numbers with as many digits as it takes
/// to read them back in single precision.
std::string usd_list(std::span<const float> numbers, int components = 1);
std::string usd_list(std::span<const std::int64_t> numbers);
std::string usd_list(std::span<const Triangle> triangles);

/// The vectors minus `from`, rounded to that many decimals where that is not negative.
std::string usd_list(std::span<const Vec3> vectors, const Vec3& from, int decimals = -1);

/// The value of an attribute at a frame, as lines indented by that many blanks.
std::string usd_sample(const UsdAttribute& attribute, int frame, std::string_view value, int indent = 4);

}  // namespace kappaflow
