#include "tools/runs/run_record.h"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <tbb/version.h>
#include <vtkVersionMacros.h>
#include <vtk_jsoncpp.h>

#include <Eigen/Core>
#include <algorithm>
#include <memory>
#include <optional>
#include <variant>

#include "core/errors.h"
#include "core/read_file.h"
#include "core/text_hash.h"
#include "core/version.h"
#include "tools/runs/run_folder.h"

namespace kappaflow {
namespace {

Json::Value list(const std::vector<std::string>& words) {
  Json::Value array(Json::arrayValue);
  for (const std::string& word : words) array.append(word);
  return array;
}

Json::Value options_record(const RunOptions& options) {
  Json::Value record;
  record["methods"] = list(options.methods);
  record["duration"] = options.duration ? Json::Value(*options.duration) : Json::Value();
  record["force"] = options.force;
  record["quiet"] = options.quiet;
  return record;
}

Json::Value list(const Vec3& vector) {
  Json::Value array(Json::arrayValue);
  for (const double component : vector) array.append(component);
  return array;
}

Json::Value scene_record(const Scene& scene) {
  Json::Value record;
  record["file"] = scene.file.string();
  record["title"] = scene.title;
  record["hash"] = text_hash(scene.text);
  record["text"] = scene.text;
  return record;
}

/// What every record says: the program, how it was called, and how surfaces are defined and tracked.
Json::Value common_record(const std::vector<std::string>& command, int threads,
                          const SurfaceDescription& surface, double sigma, std::optional<double> threshold) {
  Json::Value record;
  record["version"] = kVersion;
  record["build"] = build_description();
  record["started"] = time_now();
  record["command"] = list(command);
  record["seed"] = Json::Value();  // null: nothing in a run is random
  record["threads"] = threads;
  record["methods"] = list(surface.methods);
  record["anchor"] = std::string(name_of(kAnchors, surface.anchor));
  record["sigma"] = sigma;
  if (threshold) {
    record["kernels"] = std::string(name_of(kKernels, surface.kernels));
    record["threshold"] = *threshold;
    record["threshold_rule"] = surface.threshold ? "number" : "auto";
  }
  return record;
}

void add_ranks(const RunRanks& ranks, Json::Value& record) {
  record["ranks"] = ranks.all;
  record["liquid_ranks"] = ranks.liquid;
  for (const double share : ranks.shares) record["shares"].append(share);
}

std::string record_text(const Json::Value& record) {
  Json::StreamWriterBuilder writer;
  writer["indentation"] = "  ";
  writer["precision"] = 17;
  return Json::writeString(writer, record) + "\n";
}

bool is_vector(const Json::Value& array) {
  return array.isArray() && array.size() == 3 &&
         std::ranges::all_of(array, [](const Json::Value& number) { return number.isNumeric(); });
}

/// As far as pictures need it.
bool is_record(const Json::Value& record) {
  if (!record.isObject() || !record["methods"].isArray()) return false;
  if (!record["texture"].isNull() && !record["texture"].isString()) return false;
  const Json::Value& view = record["view"];
  return std::ranges::all_of(record["methods"], [](const Json::Value& name) { return name.isString(); }) &&
         (view.isNull() || (view.isObject() && is_vector(view["from"]) && is_vector(view["up"])));
}

}  // namespace

std::string time_now() {
  return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::chrono::system_clock::now()));
}

std::string build_description() {
  return fmt::format("compiler {} {}, {} build\nVTK {}, Eigen {}.{}.{}, oneTBB {}.{}\n",
#ifdef __clang__
                     "Clang", __clang_version__,
#else
                     "GCC", __VERSION__,
#endif
                     KAPPAFLOW_BUILD_TYPE, VTK_VERSION, EIGEN_WORLD_VERSION, EIGEN_MAJOR_VERSION,
                     EIGEN_MINOR_VERSION, TBB_VERSION_MAJOR, TBB_VERSION_MINOR);
}

RunRanks ranks_of(const RunOptions& options, const SceneFrames& frames) {
  if (options.ranks == nullptr) return {};
  return {options.ranks->size(), frames.liquid_ranks(), options.ranks->shares()};
}

std::string run_record(const RunOptions& options, const Scene& scene, const SceneFrames& frames) {
  const ParticleFieldOptions& field = frames.surfaces().field_options();
  Json::Value record =
      common_record(options.command, options.threads, scene.surface, field.sigma, field.threshold);
  add_ranks(ranks_of(options, frames), record);
  record["options"] = options_record(options);
  record["scene"] = scene_record(scene);
  record["particles"] = Json::UInt64{frames.particles()};
  record["duration"] = scene.duration;
  record["frames_per_second"] = scene.output.frames_per_second;
  record["view"]["from"] = list(scene.output.view.from);
  record["view"]["up"] = list(scene.output.view.up);
  record["texture"] = std::string(name_of(kTextureProjections, scene.output.texture));
  return record_text(record);
}

Json::Value read_record(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / kRecordFile;
  const std::string text = read_file(file);
  Json::Value record;
  std::string errors;
  const std::unique_ptr<Json::CharReader> reader(Json::CharReaderBuilder().newCharReader());
  if (!reader->parse(text.data(), text.data() + text.size(), &record, &errors) || !is_record(record))
    throw IoError(file.string(), "is not the record of a run");
  return record;
}

std::string resumed_record(const std::filesystem::path& folder, const std::vector<std::string>& command,
                           int threads, const RunRanks& ranks, double time) {
  Json::Value record = read_record(folder), resumed;
  resumed["version"] = kVersion;
  resumed["build"] = build_description();
  resumed["started"] = time_now();
  resumed["command"] = list(command);
  resumed["threads"] = threads;
  add_ranks(ranks, resumed);
  resumed["time"] = time;
  record["resumed"].append(resumed);
  return record_text(record);
}

std::string track_record(const TrackOptions& options, const TrackInput& tracked) {
  Json::Value record = common_record(options.command, options.threads, tracked.surface(),
                                     tracked.length_scale(), tracked.threshold());
  Json::Value& input = record["sequence"];
  input["name"] = tracked.name();
  input["first"] = tracked.series().files.front().string();
  input["last"] = tracked.series().files.back().string();
  input["files"] = Json::UInt64{tracked.size()};
  input["backward"] = tracked.series().backward;
  input["hash"] = tracked.hash();
  input["notes"] = list(tracked.notes());
  record["duration"] = tracked.time(tracked.size() - 1) - tracked.time(0);
  record["texture"] = std::string(name_of(kTextureProjections, options.texture));
  record["frames_per_second"] =
      options.frames_per_second ? Json::Value(*options.frames_per_second) : Json::Value();
  return record_text(record);
}

}  // namespace kappaflow
