#include "tools/render.h"

#include <fmt/format.h>
#include <vtkActor.h>
#include <vtkCamera.h>
#include <vtkLight.h>
#include <vtkNew.h>
#include <vtkPNGWriter.h>
#include <vtkPointData.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>
#include <vtkRenderWindow.h>
#include <vtkRenderer.h>
#include <vtkTextActor.h>
#include <vtkTextProperty.h>
#include <vtkUnsignedCharArray.h>
#include <vtkWindowToImageFilter.h>
#include <vtk_jsoncpp.h>

#include <algorithm>
#include <memory>
#include <string_view>

#include "core/errors.h"
#include "tools/data_files.h"
#include "tools/display.h"
#include "tools/files.h"
#include "tools/run_folder.h"

namespace kappaflow {
namespace {

namespace fs = std::filesystem;

constexpr int kPanelWidth = 900, kPanelHeight = 800;  // [pixels]
constexpr int kMultisamples = 8;
constexpr double kFilled = 0.94, kTitleShare = 0.06;  // of half a panel

/// What run.json says about the run, as far as pictures need it.
struct RunFacts {
  std::vector<std::string> methods;
  double frames_per_second = 0, duration = 0;
};

RunFacts read_run_facts(const fs::path& folder) {
  const fs::path file = folder / kRecordFile;
  const std::string text = read_file(file);
  Json::Value record;
  std::string errors;
  const std::unique_ptr<Json::CharReader> reader(Json::CharReaderBuilder().newCharReader());
  if (!reader->parse(text.data(), text.data() + text.size(), &record, &errors) ||
      !record["methods"].isArray())
    throw IoError(file.string(), "is not the record of a run");
  RunFacts facts;
  for (const Json::Value& method : record["methods"]) facts.methods.push_back(method.asString());
  facts.frames_per_second = record["frames_per_second"].asDouble();
  facts.duration = record["duration"].asDouble();
  return facts;
}

std::vector<std::string> chosen_methods(const RenderOptions& options, const RunFacts& facts) {
  if (options.methods.empty()) return facts.methods;
  for (const std::string& method : options.methods)
    if (std::ranges::find(facts.methods, method) == facts.methods.end())
      throw InvalidInput(
          fmt::format("{} has no surface tracked with \"{}\"", options.folder.string(), method));
  return options.methods;
}

bool has_frame(const fs::path& folder, const std::vector<std::string>& methods, int frame) {
  return std::ranges::all_of(methods,
                             [&](const auto& m) { return fs::exists(folder / surface_file(m, frame)); });
}

int chosen_frame(const RenderOptions& options, const std::vector<std::string>& methods) {
  int frames = 0;
  while (has_frame(options.folder, methods, frames)) ++frames;
  if (options.frame < frames && frames > 0) return options.frame >= 0 ? options.frame : frames - 1;
  throw InvalidInput(frames == 0 ? fmt::format("{} has no frames yet", options.folder.string())
                                 : fmt::format("{} has frames 0 to {}, not {}", options.folder.string(),
                                               frames - 1, options.frame));
}

vtkSmartPointer<vtkActor> make_actor(vtkPolyData& data) {
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputData(&data);
  auto actor = vtkSmartPointer<vtkActor>::New();
  actor->SetMapper(mapper);
  return actor;
}

vtkSmartPointer<vtkActor> surface_actor(const fs::path& file) {
  const vtkSmartPointer<vtkPolyData> data = read_vtp(file);
  data->GetPointData()->SetActiveScalars("checker");
  auto actor = make_actor(*data);
  actor->GetMapper()->SetColorModeToDirectScalars();
  vtkProperty& look = *actor->GetProperty();
  look.SetInterpolationToPhong();
  look.SetAmbient(0.3);
  look.SetDiffuse(0.85);
  look.SetSpecular(0.12);
  look.SetSpecularPower(25);
  return actor;
}

vtkSmartPointer<vtkActor> boundary_actor(const fs::path& file) {
  auto actor = make_actor(*read_vtp(file));
  actor->GetProperty()->SetColor(0.9, 0.91, 0.92);
  actor->GetProperty()->SetAmbient(0.35);
  actor->GetProperty()->SetDiffuse(0.7);
  return actor;
}

vtkSmartPointer<vtkTextActor> title_actor(const std::string& text) {
  auto title = vtkSmartPointer<vtkTextActor>::New();
  title->SetInput(text.c_str());
  vtkTextProperty& look = *title->GetTextProperty();
  look.SetFontSize(30);
  look.SetFontFamilyToArial();
  look.SetColor(0.15, 0.15, 0.18);
  look.SetJustificationToCentered();
  title->SetPosition(kPanelWidth / 2.0, kPanelHeight - 56);
  return title;
}

// A key light from above behind the viewer and a weaker one from the side, so that no slope is black.
void add_lights(vtkRenderer& renderer) {
  const auto add = [&](double x, double y, double z, double intensity) {
    vtkNew<vtkLight> light;
    light->SetLightTypeToCameraLight();
    light->SetPosition(x, y, z);
    light->SetFocalPoint(0, 0, 0);
    light->SetIntensity(intensity);
    renderer.AddLight(light);
  };
  add(0.3, 1, 0.9, 0.8);
  add(-1, 0.1, 0.7, 0.45);
}

// Looks at `subject` from the foot of the stairs, the right and above, and fills the panel below the title
// with it; gravity points down in the picture.
void aim(vtkRenderer& renderer, vtkPolyData& subject) {
  vtkCamera& camera = *renderer.GetActiveCamera();
  camera.SetPosition(0.9, 0.65, 1);
  camera.SetViewUp(0, 1, 0);
  camera.SetViewAngle(24);
  renderer.ResetCamera(subject.GetBounds());

  // Where the subject lies on the screen, in [-1, 1] on both axes.
  Vec2 lower = Vec2::Constant(1e9), upper = Vec2::Constant(-1e9);
  for (vtkIdType i = 0; i < subject.GetNumberOfPoints(); ++i) {
    Vec3 at(subject.GetPoint(i));
    renderer.WorldToView(at[0], at[1], at[2]);
    lower = lower.cwiseMin(at.head<2>());
    upper = upper.cwiseMax(at.head<2>());
  }
  const Vec2 center = 0.5 * (lower + upper), size = upper - lower;
  const double zoom = std::min(2 * kFilled / size.x(), 2 * (kFilled - kTitleShare) / size.y());
  camera.SetWindowCenter(zoom * center.x(), zoom * center.y() + kTitleShare);
  camera.Zoom(zoom);
}

struct Panel {
  std::string title;
  fs::path surface;
};

void fill_panel(vtkRenderer& renderer, const Panel& panel, const fs::path& boundary, vtkPolyData& subject) {
  renderer.SetBackground(1, 1, 1);
  renderer.AddActor(surface_actor(panel.surface));
  if (fs::exists(boundary)) renderer.AddActor(boundary_actor(boundary));
  renderer.AddActor2D(title_actor(panel.title));
  add_lights(renderer);
  aim(renderer, subject);
  renderer.ResetCameraClippingRange();
}

// What fills the picture: the walls, or without walls the first surface. The same in every frame of a run.
vtkSmartPointer<vtkPolyData> subject_of(const fs::path& boundary, const fs::path& first_surface) {
  return read_vtp(fs::exists(boundary) ? boundary : first_surface);
}

void write_png(vtkRenderWindow& window, const fs::path& picture) {
  vtkNew<vtkWindowToImageFilter> image;
  image->SetInput(&window);
  image->ReadFrontBufferOff();
  vtkNew<vtkPNGWriter> writer;
  writer->SetInputConnection(image->GetOutputPort());
  writer->WriteToMemoryOn();
  writer->Write();
  const vtkUnsignedCharArray& png = *writer->GetResult();
  const auto* bytes = reinterpret_cast<const char*>(const_cast<vtkUnsignedCharArray&>(png).GetPointer(0));
  write_file(picture, {bytes, static_cast<std::size_t>(png.GetNumberOfValues())});
}

}  // namespace

void render(const RenderOptions& options) {
  if (options.picture.extension() != ".png")
    throw InvalidInput(
        fmt::format("--out: found \"{}\"; expected a file name that ends in .png", options.picture.string()));
  const RunFacts facts = read_run_facts(options.folder);
  const std::vector<std::string> methods = chosen_methods(options, facts);
  const int frame = chosen_frame(options, methods);
  // VTK aborts the program when there is no display: ask first.
  if (!has_display()) throw IoError("DISPLAY", "there is no display to draw with; run under xvfb-run -a");

  const double time = std::min(frame / facts.frames_per_second, facts.duration);
  const fs::path boundary = options.folder / kBoundaryFile;
  const auto subject = subject_of(boundary, options.folder / surface_file(methods.front(), 0));

  const auto panels = static_cast<double>(methods.size());
  vtkNew<vtkRenderWindow> window;
  window->SetOffScreenRendering(1);
  window->SetMultiSamples(kMultisamples);
  window->SetSize(kPanelWidth * static_cast<int>(methods.size()), kPanelHeight);
  for (std::size_t m = 0; m < methods.size(); ++m) {
    vtkNew<vtkRenderer> renderer;
    renderer->SetViewport(static_cast<double>(m) / panels, 0, static_cast<double>(m + 1) / panels, 1);
    window->AddRenderer(renderer);  // first: the view depends on the panel's shape
    const Panel panel{fmt::format("{},  t = {:.2f} s", methods[m], time),
                      options.folder / surface_file(methods[m], frame)};
    fill_panel(*renderer, panel, boundary, *subject);
  }
  window->Render();
  write_png(*window, options.picture);
}

}  // namespace kappaflow
