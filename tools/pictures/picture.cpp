#include "tools/pictures/picture.h"

#include <fmt/format.h>
#include <vtkActor.h>
#include <vtkCamera.h>
#include <vtkFloatArray.h>
#include <vtkImageData.h>
#include <vtkLight.h>
#include <vtkMapper.h>
#include <vtkMatrix4x4.h>
#include <vtkNew.h>
#include <vtkPNGWriter.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>
#include <vtkRenderWindow.h>
#include <vtkRenderer.h>
#include <vtkUnsignedCharArray.h>
#include <vtkWindowToImageFilter.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/errors.h"
#include "tools/io/files.h"
#include "tools/pictures/colour_bar.h"
#include "tools/pictures/display.h"
#include "tools/pictures/hiding_walls.h"
#include "tools/pictures/name_regions.h"
#include "tools/pictures/shadow.h"
#include "tools/pictures/text_label.h"
#include "tools/pictures/textured_actor.h"

namespace kappaflow {
namespace {

constexpr int kSamples = 2;                                       // of a pixel along each axis
constexpr double kOcclusionReach = 0.06, kOcclusionBias = 0.004;  // of what fills the panel
constexpr unsigned int kOcclusionSamples = 64;
constexpr int kRim = 8;  // samples that are drawn and left out: there the occlusion is that of the other side
constexpr double kTitleHeight = 0.09, kPanelGap = 0.012;  // of a panel
constexpr int kLeastTitle = 40;                           // [pixels]
constexpr double kViewAngle = 24;                         // [degrees] from bottom to top
constexpr double kGlass = 0.12;                           // opacity of walls in the way
constexpr double kBarHeight = 0.15;                       // of a panel's
constexpr int kLightPixels = 1024;                        // along an edge of what the key light sees
constexpr double kAmbient = 0.38, kDiffuse = 0.7;         // of all that is lit
// The key light comes from above, beside the viewer, so that shadows are seen; the fill light from the other
// side.
constexpr double kKeyLight = 0.8, kFillLight = 0.5;
const Vec3 kKeyFrom(-0.7, 1, 0.6), kFillFrom(1, 0.1, 0.7);  // right, up, towards the viewer

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
  auto actor =
      style.colouring ? coloured_actor(surface, *style.colouring) : textured_actor(surface, style.texture);
  vtkProperty& look = *actor->GetProperty();
  look.SetInterpolationToPhong();
  look.SetAmbient(kAmbient);
  look.SetDiffuse(kDiffuse);
  look.SetSpecular(style.colouring ? 0 : 0.15);  // a highlight would look like other data
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
  actor->GetProperty()->SetAmbient(kAmbient);
  actor->GetProperty()->SetDiffuse(kDiffuse);
  return actor;
}

void add_lights(vtkRenderer& renderer) {
  const auto add = [&](const Vec3& from, double intensity) {
    vtkNew<vtkLight> light;
    light->SetLightTypeToCameraLight();
    light->SetPosition(from.x(), from.y(), from.z());
    light->SetFocalPoint(0, 0, 0);
    light->SetIntensity(intensity);
    renderer.AddLight(light);
  };
  add(kKeyFrom, kKeyLight);
  add(kFillFrom, kFillLight);
}

Lighting lighting_of(const View& view) {
  const Mat3 to_world = view_axes(view).transpose();
  return {to_world * kKeyFrom.normalized(), to_world * kFillFrom.normalized(), kAmbient, kDiffuse * kKeyLight,
          kDiffuse * kFillLight};
}

/// So far from the middle of what is framed.
void place(vtkCamera& camera, const Framing& framing, const View& view, double distance) {
  const Mat3 axes = view_axes(view);
  const Vec3 centre = axes.transpose() * framing.centre, eye = centre + distance * axes.row(2).transpose();
  camera.SetFocalPoint(centre.data());
  camera.SetPosition(eye.data());
  camera.SetViewUp(view.up.data());
}

/// Fills the renderer's window with what is framed.
void aim(vtkRenderer& renderer, const Framing& framing, const PictureStyle& style) {
  const double slope = std::tan(0.5 * kViewAngle * std::numbers::pi / 180);
  const double wide = framing.half.x() / renderer.GetTiledAspectRatio();
  place(*renderer.GetActiveCamera(), framing, style.view,
        framing.half.z() + std::max({wide, framing.half.y(), 1e-9}) / slope);
  renderer.GetActiveCamera()->SetViewAngle(kViewAngle);
  renderer.ResetCameraClippingRange();
}

void add_walls(vtkRenderer& renderer, const DrawnWalls& walls) {
  if (walls.solid) renderer.AddActor(wall_actor(*walls.solid, 1));
  if (!walls.glass || walls.glass->GetNumberOfCells() == 0) return;
  renderer.AddActor(wall_actor(*walls.glass, kGlass));
  const auto edges = make_actor(*sharp_edges(*walls.glass));
  edges->GetProperty()->SetColor(0.6, 0.62, 0.65);
  edges->GetProperty()->SetLineWidth(kSamples);
  edges->GetProperty()->LightingOff();
  renderer.AddActor(edges);
}

void fill_panel(vtkRenderer& renderer, vtkPolyData& surface, const DrawnWalls& walls, const Framing& framing,
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

/// What `take` takes of a renderer that `fill` has filled, and that is drawn with so many pixels.
template <class Fill, class Take>
auto drawn(int width, int height, const Fill& fill, const Take& take) {
  vtkRenderWindow& window = canvas();
  window.SetSize(width, height);
  vtkNew<vtkRenderer> renderer;
  renderer->SetBackground(1, 1, 1);
  window.AddRenderer(renderer);
  fill(*renderer);
  window.Render();
  auto taken = take(*renderer);
  window.RemoveRenderer(renderer);
  return taken;
}

vtkSmartPointer<vtkImageData> shown_by(vtkRenderer& renderer) {
  vtkNew<vtkWindowToImageFilter> image;
  image->SetInput(renderer.GetRenderWindow());
  image->ReadFrontBufferOff();
  image->Update();
  return image->GetOutput();
}

DepthImage depths_of(vtkRenderer& renderer) {
  const int* size = renderer.GetRenderWindow()->GetSize();
  DepthImage image{size[0], size[1], {}, {}};
  vtkNew<vtkFloatArray> depth;
  renderer.GetRenderWindow()->GetZbufferData(0, 0, size[0] - 1, size[1] - 1, depth);
  image.depth.assign(depth->GetPointer(0), depth->GetPointer(0) + depth->GetNumberOfValues());
  const vtkMatrix4x4& matrix = *renderer.GetActiveCamera()->GetCompositeProjectionTransformMatrix(
      renderer.GetTiledAspectRatio(), -1, 1);
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column) image.to_image(row, column) = matrix.GetElement(row, column);
  return image;
}

/// Of the surface alone, seen along the key light.
DepthImage depths_from(const Vec3& key, const Vec3& up, vtkPolyData& surface) {
  const View view{key, up};
  vtkPolyData* const parts[] = {&surface};
  const Framing around = framing(parts, view, 0);
  const auto fill = [&](vtkRenderer& renderer) {
    renderer.AddActor(make_actor(surface));
    vtkCamera& camera = *renderer.GetActiveCamera();
    place(camera, around, view, 2 * around.half.z());
    camera.ParallelProjectionOn();
    camera.SetParallelScale(1.02 * std::max(around.half.x(), around.half.y()));
    camera.SetClippingRange(0.9 * around.half.z(), 3.1 * around.half.z());
  };
  return drawn(kLightPixels, kLightPixels, fill, depths_of);
}

unsigned char* pixel(vtkImageData& image, int x, int y) {
  return static_cast<unsigned char*>(image.GetScalarPointer(x, y, 0));
}

/// Puts the means of a part's samples into the picture, from (left, below) on; `rim` of them are left out all
/// around.
void put(vtkImageData& part, int left, int below, vtkImageData& picture, int rim = 0) {
  const int width = (part.GetDimensions()[0] - 2 * rim) / kSamples,
            height = (part.GetDimensions()[1] - 2 * rim) / kSamples;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (int channel = 0; channel < 3; ++channel) {
        int sum = kSamples * kSamples / 2;
        for (int j = 0; j < kSamples; ++j)
          for (int i = 0; i < kSamples; ++i)
            sum += pixel(part, rim + kSamples * x + i, rim + kSamples * y + j)[channel];
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

/// The surface among the walls and in its shadow, with kSamples pixels for one along each axis, and a rim.
vtkSmartPointer<vtkImageData> surface_image(vtkPolyData& surface, const DrawnWalls& walls,
                                            const Framing& framing, const PictureStyle& style, int width,
                                            int height) {
  DepthImage depths;
  auto image = drawn(
      kSamples * width + 2 * kRim, kSamples * height + 2 * kRim,
      [&](vtkRenderer& renderer) { fill_panel(renderer, surface, walls, framing, style); },
      [&](vtkRenderer& renderer) {
        depths = depths_of(renderer);
        return shown_by(renderer);
      });
  const Lighting lighting = lighting_of(style.view);
  cast_shadows(*image, depths, depths_from(lighting.key, style.view.up, surface), lighting);
  return image;
}

/// What has two dimensions, with kSamples pixels for one along each axis.
template <class Fill>
vtkSmartPointer<vtkImageData> flat_image(int width, int height, const Fill& fill) {
  return drawn(
      kSamples * width, kSamples * height,
      [&](vtkRenderer& renderer) { fill(renderer, kSamples * width, kSamples * height); }, shown_by);
}

/// From (left, below) on: the surface among the walls, its title above.
void put_panel(const Panel& panel, const DrawnWalls& walls, const std::optional<Framing>& framing,
               const PictureStyle& style, int left, int below, vtkImageData& picture) {
  const int title = std::max(kLeastTitle, share(kTitleHeight, style.panel_height)),
            gap = share(kPanelGap, style.panel_width), width = style.panel_width - 2 * gap,
            height = style.panel_height - title;
  vtkPolyData* const alone[] = {panel.surface.Get()};
  const Framing here = framing ? *framing : kappaflow::framing(alone, style.view, 0);
  put(*surface_image(*panel.surface, walls, here, style, width, height), left + gap, below, picture, kRim);
  const auto add_title = [&](vtkRenderer& renderer, int across, int up) {
    renderer.AddActor2D(text_label(panel.title, across / 2.0, up / 2.0, up / 2));
  };
  put(*flat_image(width, title, add_title), left + gap, below + height, picture);
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

void draw_picture(const std::filesystem::path& file, std::span<const Panel> panels, const DrawnWalls& walls,
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
    const auto bar =
        flat_image(style.panel_width, bar_height, [&](vtkRenderer& renderer, int width, int height) {
          add_bar_labels(renderer, *style.colouring, width, height);
        });
    paint_bar(*bar, *style.colouring);
    put(*bar, (columns - 1) * style.panel_width / 2, 0, *picture);
  }
  write_png(*picture, file);
}

}  // namespace kappaflow
