#include "tools/pictures/picture.h"

#include <fmt/format.h>
#include <vtkActor.h>
#include <vtkCamera.h>
#include <vtkImageData.h>
#include <vtkLight.h>
#include <vtkMapper.h>
#include <vtkNew.h>
#include <vtkPNGWriter.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>
#include <vtkRenderWindow.h>
#include <vtkRenderer.h>
#include <vtkScalarBarActor.h>
#include <vtkTextActor.h>
#include <vtkTextProperty.h>
#include <vtkUnsignedCharArray.h>
#include <vtkWindowToImageFilter.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/errors.h"
#include "tools/io/files.h"
#include "tools/pictures/checker_actor.h"
#include "tools/pictures/display.h"
#include "tools/pictures/hiding_walls.h"
#include "tools/pictures/name_regions.h"

namespace kappaflow {
namespace {

constexpr int kSamples = 2;                                       // of a pixel along each axis
constexpr double kOcclusionReach = 0.12, kOcclusionBias = 0.004;  // of what fills the panel
constexpr unsigned int kOcclusionSamples = 64;
constexpr double kTitleHeight = 0.075, kGap = 0.012;  // of a panel
constexpr double kViewAngle = 24;                     // [degrees] from bottom to top
constexpr double kGlass = 0.12;                       // opacity of walls in the way
constexpr double kBarHeight = 0.11;                   // of a panel's

vtkSmartPointer<vtkActor> make_actor(vtkPolyData& data) {
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputData(&data);
  auto actor = vtkSmartPointer<vtkActor>::New();
  actor->SetMapper(mapper);
  return actor;
}

vtkSmartPointer<vtkActor> coloured_actor(vtkPolyData& surface, const Colouring& colouring) {
  const bool of_names = colouring.table->GetIndexedLookup() != 0;
  auto actor = make_actor(of_names ? *name_regions(surface, colouring.array) : surface);
  vtkMapper& mapper = *actor->GetMapper();
  if (of_names)
    mapper.SetScalarModeToUseCellFieldData();
  else
    mapper.SetScalarModeToUsePointFieldData();
  mapper.SelectColorArray(colouring.array.c_str());
  mapper.SetColorModeToMapScalars();
  mapper.SetLookupTable(colouring.table);
  mapper.UseLookupTableScalarRangeOn();
  mapper.SetInterpolateScalarsBeforeMapping(!of_names);
  return actor;
}

vtkSmartPointer<vtkActor> surface_actor(vtkPolyData& surface, const PictureStyle& style) {
  auto actor = style.colouring ? coloured_actor(surface, *style.colouring) : checker_actor(surface);
  vtkProperty& look = *actor->GetProperty();
  look.SetInterpolationToPhong();
  look.SetAmbient(0.32);
  look.SetDiffuse(0.75);
  look.SetSpecular(0.15);
  look.SetSpecularPower(40);
  return actor;
}

/// Of the triangles: as an actor of their own, for what VTK adds to a surface that shows its edges drops the
/// checker's coordinates.
vtkSmartPointer<vtkActor> edge_actor(vtkPolyData& surface) {
  auto actor = make_actor(surface);
  actor->GetMapper()->ScalarVisibilityOff();
  actor->GetMapper()->SetResolveCoincidentTopologyToPolygonOffset();
  vtkProperty& look = *actor->GetProperty();
  look.SetRepresentationToWireframe();
  look.SetColor(0.25, 0.25, 0.3);
  look.SetLineWidth(kSamples);
  look.LightingOff();
  return actor;
}

vtkSmartPointer<vtkActor> wall_actor(vtkPolyData& data, double opacity) {
  auto actor = make_actor(data);
  actor->GetProperty()->SetOpacity(opacity);
  actor->GetProperty()->SetColor(0.9, 0.91, 0.92);
  actor->GetProperty()->SetAmbient(0.35);
  actor->GetProperty()->SetDiffuse(0.7);
  return actor;
}

void write_dark(vtkTextProperty& look, int size) {
  look.SetFontSize(size);
  look.SetFontFamilyToArial();
  look.SetColor(0.15, 0.15, 0.18);
  look.BoldOff();
  look.ItalicOff();
  look.ShadowOff();
}

/// In the middle of an image of that width and height.
vtkSmartPointer<vtkTextActor> title_actor(const std::string& text, int width, int height) {
  auto title = vtkSmartPointer<vtkTextActor>::New();
  title->SetInput(text.c_str());
  vtkTextProperty& look = *title->GetTextProperty();
  write_dark(look, kSamples * height / 2);
  look.SetJustificationToCentered();
  look.SetVerticalJustificationToCentered();
  title->SetPosition(kSamples * width / 2.0, kSamples * height / 2.0);
  return title;
}

vtkSmartPointer<vtkScalarBarActor> bar_actor(const Colouring& colouring, int height) {
  auto bar = vtkSmartPointer<vtkScalarBarActor>::New();
  bar->SetLookupTable(colouring.table);
  bar->SetTitle(colouring.title.c_str());
  bar->SetOrientationToHorizontal();
  bar->SetPosition(0.05, 0.02);
  bar->SetPosition2(0.9, colouring.table->GetIndexedLookup() ? 0.56 : 0.9);  // names stand above
  bar->SetNumberOfLabels(colouring.labels);
  bar->SetTextPositionToPrecedeScalarBar();
  bar->SetLabelFormat("%.4g");
  bar->UnconstrainedFontSizeOn();
  write_dark(*bar->GetTitleTextProperty(), kSamples * height * 3 / 10);
  write_dark(*bar->GetLabelTextProperty(), kSamples * height * 3 / 10);
  write_dark(*bar->GetAnnotationTextProperty(), kSamples * height * 3 / 10);
  return bar;
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

/// Fills the renderer's window with what is framed.
void aim(vtkRenderer& renderer, const Framing& framing, const PictureStyle& style) {
  const double slope = std::tan(0.5 * kViewAngle * std::numbers::pi / 180);
  const double wide = framing.half.x() / renderer.GetTiledAspectRatio();
  const double distance = framing.half.z() + std::max({wide, framing.half.y(), 1e-9}) / slope;
  const Mat3 axes = view_axes(style.view);
  const Vec3 centre = axes.transpose() * framing.centre, eye = centre + distance * axes.row(2).transpose();
  vtkCamera& camera = *renderer.GetActiveCamera();
  camera.SetFocalPoint(centre.data());
  camera.SetPosition(eye.data());
  camera.SetViewUp(style.view.up.data());
  camera.SetViewAngle(kViewAngle);
  renderer.ResetCameraClippingRange();
}

void add_walls(vtkRenderer& renderer, const Walls& walls) {
  if (walls.solid) renderer.AddActor(wall_actor(*walls.solid, 1));
  if (!walls.glass || walls.glass->GetNumberOfCells() == 0) return;
  renderer.AddActor(wall_actor(*walls.glass, kGlass));
  const auto edges = make_actor(*sharp_edges(*walls.glass));
  edges->GetProperty()->SetColor(0.6, 0.62, 0.65);
  edges->GetProperty()->SetLineWidth(kSamples);
  edges->GetProperty()->LightingOff();
  renderer.AddActor(edges);
}

void fill_panel(vtkRenderer& renderer, vtkPolyData& surface, const Walls& walls, const Framing& framing,
                const PictureStyle& style) {
  renderer.SetBackground(1, 1, 1);
  renderer.AddActor(surface_actor(surface, style));
  if (style.edges) renderer.AddActor(edge_actor(surface));
  add_walls(renderer, walls);
  add_lights(renderer);
  aim(renderer, framing, style);
  const double size = 2 * framing.half.norm();
  renderer.UseSSAOOn();
  renderer.SetSSAORadius(kOcclusionReach * size);
  renderer.SetSSAOBias(kOcclusionBias * size);
  renderer.SetSSAOKernelSize(kOcclusionSamples);
  renderer.SSAOBlurOn();
}

/// One for all that is drawn, and never closed: VTK aborts where it opens a window of a display that has
/// ended, as a virtual one does before the program when that is told to.
vtkRenderWindow& canvas() {
  static vtkRenderWindow* const window = [] {
    vtkRenderWindow* const opened = vtkRenderWindow::New();
    opened->SetOffScreenRendering(1);
    opened->SetMultiSamples(0);
    return opened;
  }();
  return *window;
}

/// What a renderer shows, with kSamples pixels for one along each axis.
template <class Fill>
vtkSmartPointer<vtkImageData> drawn(int width, int height, const Fill& fill) {
  vtkRenderWindow& window = canvas();
  window.SetSize(kSamples * width, kSamples * height);
  vtkNew<vtkRenderer> renderer;
  renderer->SetBackground(1, 1, 1);
  window.AddRenderer(renderer);
  fill(*renderer);
  window.Render();
  vtkNew<vtkWindowToImageFilter> image;
  image->SetInput(&window);
  image->ReadFrontBufferOff();
  image->Update();
  window.RemoveRenderer(renderer);
  return image->GetOutput();
}

unsigned char* pixel(vtkImageData& image, int x, int y) {
  return static_cast<unsigned char*>(image.GetScalarPointer(x, y, 0));
}

/// Puts the means of a part's samples into the picture, from (left, below) on.
void put(vtkImageData& part, int left, int below, vtkImageData& picture) {
  const int width = part.GetDimensions()[0] / kSamples, height = part.GetDimensions()[1] / kSamples;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (int channel = 0; channel < 3; ++channel) {
        int sum = kSamples * kSamples / 2;
        for (int j = 0; j < kSamples; ++j)
          for (int i = 0; i < kSamples; ++i) sum += pixel(part, kSamples * x + i, kSamples * y + j)[channel];
        pixel(picture, left + x, below + y)[channel] =
            static_cast<unsigned char>(sum / (kSamples * kSamples));
      }
}

vtkSmartPointer<vtkImageData> white_picture(int width, int height) {
  auto picture = vtkSmartPointer<vtkImageData>::New();
  picture->SetDimensions(width, height, 1);
  picture->AllocateScalars(VTK_UNSIGNED_CHAR, 3);
  std::fill_n(pixel(*picture, 0, 0), std::size_t{3} * width * height, static_cast<unsigned char>(255));
  return picture;
}

int share(double of_panel, int size) {
  return static_cast<int>(std::lround(of_panel * size));
}

/// From (left, below) on: the surface among the walls, its title above.
void put_panel(const Panel& panel, const Walls& walls, const std::optional<Framing>& framing,
               const PictureStyle& style, int left, int below, vtkImageData& picture) {
  const int title = share(kTitleHeight, style.panel_height), gap = share(kGap, style.panel_width),
            width = style.panel_width - 2 * gap, height = style.panel_height - title;
  vtkPolyData* const alone[] = {panel.surface.Get()};
  const Framing here = framing ? *framing : kappaflow::framing(alone, style.view, 0);
  put(*drawn(width, height,
             [&](vtkRenderer& renderer) { fill_panel(renderer, *panel.surface, walls, here, style); }),
      left + gap, below, picture);
  put(*drawn(width, title,
             [&](vtkRenderer& renderer) { renderer.AddActor2D(title_actor(panel.title, width, title)); }),
      left + gap, below + height, picture);
}

void write_png(vtkImageData& picture, const std::filesystem::path& file) {
  vtkNew<vtkPNGWriter> writer;
  writer->SetInputData(&picture);
  writer->WriteToMemoryOn();
  writer->Write();
  const vtkUnsignedCharArray& png = *writer->GetResult();
  const auto* bytes = reinterpret_cast<const char*>(const_cast<vtkUnsignedCharArray&>(png).GetPointer(0));
  write_file(file, {bytes, static_cast<std::size_t>(png.GetNumberOfValues())});
}

}  // namespace

void draw_picture(const std::filesystem::path& file, std::span<const Panel> panels, const Walls& walls,
                  const std::optional<Framing>& framing, const PictureStyle& style) {
  if (file.extension() != ".png")
    throw InvalidInput(fmt::format("found \"{}\"; expected a file name that ends in .png", file.string()));
  // VTK aborts the program when there is no display: ask first.
  if (!has_display()) throw IoError("DISPLAY", "there is no display to draw with; run under xvfb-run -a");

  const int count = static_cast<int>(panels.size());
  const int columns = style.columns > 0 ? style.columns : count, rows = (count + columns - 1) / columns;
  const int bar_height = style.colouring ? share(kBarHeight, style.panel_height) : 0;
  const auto picture = white_picture(style.panel_width * columns, style.panel_height * rows + bar_height);
  for (int p = 0; p < count; ++p)
    put_panel(panels[p], walls, framing, style, p % columns * style.panel_width,
              bar_height + (rows - 1 - p / columns) * style.panel_height, *picture);
  if (style.colouring) {
    const auto bar = drawn(style.panel_width, bar_height, [&](vtkRenderer& renderer) {
      renderer.AddActor2D(bar_actor(*style.colouring, bar_height));
    });
    put(*bar, (columns - 1) * style.panel_width / 2, 0, *picture);
  }
  write_png(*picture, file);
}

}  // namespace kappaflow
