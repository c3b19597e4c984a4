#include "tools/pictures/picture.h"

#include <fmt/format.h>
#include <vtkActor.h>
#include <vtkCamera.h>
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

#include "core/errors.h"
#include "tools/io/files.h"
#include "tools/pictures/display.h"

namespace kappaflow {
namespace {

constexpr int kMultisamples = 8;
constexpr double kFilled = 0.94, kTitleShare = 0.06, kBarShare = 0.1;  // of half a panel

vtkSmartPointer<vtkActor> make_actor(vtkPolyData& data) {
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputData(&data);
  auto actor = vtkSmartPointer<vtkActor>::New();
  actor->SetMapper(mapper);
  return actor;
}

void colour(vtkMapper& mapper, const std::optional<Colouring>& colouring) {
  mapper.SetScalarModeToUsePointFieldData();
  mapper.SelectColorArray(colouring ? colouring->array.c_str() : kCheckerArray);
  if (!colouring) {
    mapper.SetColorModeToDirectScalars();
    return;
  }
  mapper.SetColorModeToMapScalars();
  mapper.SetLookupTable(colouring->table);
  mapper.UseLookupTableScalarRangeOn();
  mapper.SetInterpolateScalarsBeforeMapping(!colouring->table->GetIndexedLookup());
}

vtkSmartPointer<vtkActor> surface_actor(vtkPolyData& data, const PictureStyle& style) {
  auto actor = make_actor(data);
  colour(*actor->GetMapper(), style.colouring);
  vtkProperty& look = *actor->GetProperty();
  look.SetInterpolationToPhong();
  look.SetAmbient(0.3);
  look.SetDiffuse(0.85);
  look.SetSpecular(0.12);
  look.SetSpecularPower(25);
  look.SetEdgeVisibility(style.edges);
  look.SetEdgeColor(0.25, 0.25, 0.3);
  return actor;
}

vtkSmartPointer<vtkActor> boundary_actor(vtkPolyData& data, const PictureStyle& style) {
  auto actor = make_actor(data);
  actor->GetProperty()->SetOpacity(style.wall_opacity);
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

vtkSmartPointer<vtkTextActor> title_actor(const std::string& text, const PictureStyle& style) {
  auto title = vtkSmartPointer<vtkTextActor>::New();
  title->SetInput(text.c_str());
  vtkTextProperty& look = *title->GetTextProperty();
  write_dark(look, style.panel_height * 3 / 80);
  look.SetJustificationToCentered();
  title->SetPosition(style.panel_width / 2.0, style.panel_height * 0.93);
  return title;
}

vtkSmartPointer<vtkScalarBarActor> bar_actor(const Colouring& colouring, const PictureStyle& style) {
  auto bar = vtkSmartPointer<vtkScalarBarActor>::New();
  bar->SetLookupTable(colouring.table);
  bar->SetTitle(colouring.title.c_str());
  bar->SetOrientationToHorizontal();
  bar->SetPosition(0.2, 0.01);
  bar->SetPosition2(0.6, kBarShare);
  bar->SetNumberOfLabels(5);
  bar->SetTextPositionToPrecedeScalarBar();
  bar->SetLabelFormat("%.3g");
  bar->UnconstrainedFontSizeOn();
  write_dark(*bar->GetTitleTextProperty(), style.panel_height / 36);
  write_dark(*bar->GetLabelTextProperty(), style.panel_height / 36);
  write_dark(*bar->GetAnnotationTextProperty(), style.panel_height / 36);
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

// Looks at `subject` and fills the panel with it, between the title and the colour bar where there is one.
void aim(vtkRenderer& renderer, vtkPolyData& subject, const PictureStyle& style) {
  vtkCamera& camera = *renderer.GetActiveCamera();
  camera.SetPosition(style.view.from.data());
  camera.SetViewUp(style.view.up.data());
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
  const double bar = style.colouring ? kBarShare : 0;
  const double zoom = std::min(2 * kFilled / size.x(), 2 * (kFilled - kTitleShare - bar) / size.y());
  camera.SetWindowCenter(zoom * center.x(), zoom * center.y() + kTitleShare - bar);
  camera.Zoom(zoom);
}

void fill_panel(vtkRenderer& renderer, const Panel& panel, vtkPolyData* boundary, vtkPolyData& subject,
                const PictureStyle& style) {
  renderer.SetBackground(1, 1, 1);
  renderer.AddActor(surface_actor(*panel.surface, style));
  if (boundary != nullptr) renderer.AddActor(boundary_actor(*boundary, style));
  renderer.AddActor2D(title_actor(panel.title, style));
  if (style.colouring) renderer.AddActor2D(bar_actor(*style.colouring, style));
  add_lights(renderer);
  aim(renderer, subject, style);
  renderer.ResetCameraClippingRange();
}

void write_png(vtkRenderWindow& window, const std::filesystem::path& file) {
  vtkNew<vtkWindowToImageFilter> image;
  image->SetInput(&window);
  image->ReadFrontBufferOff();
  vtkNew<vtkPNGWriter> writer;
  writer->SetInputConnection(image->GetOutputPort());
  writer->WriteToMemoryOn();
  writer->Write();
  const vtkUnsignedCharArray& png = *writer->GetResult();
  const auto* bytes = reinterpret_cast<const char*>(const_cast<vtkUnsignedCharArray&>(png).GetPointer(0));
  write_file(file, {bytes, static_cast<std::size_t>(png.GetNumberOfValues())});
}

}  // namespace

void draw_picture(const std::filesystem::path& file, std::span<const Panel> panels, vtkPolyData* boundary,
                  vtkPolyData* subject, const PictureStyle& style) {
  if (file.extension() != ".png")
    throw InvalidInput(fmt::format("found \"{}\"; expected a file name that ends in .png", file.string()));
  // VTK aborts the program when there is no display: ask first.
  if (!has_display()) throw IoError("DISPLAY", "there is no display to draw with; run under xvfb-run -a");

  const int count = static_cast<int>(panels.size());
  const int columns = style.columns > 0 ? style.columns : count, rows = (count + columns - 1) / columns;
  vtkNew<vtkRenderWindow> window;
  window->SetOffScreenRendering(1);
  window->SetMultiSamples(kMultisamples);
  window->SetSize(style.panel_width * columns, style.panel_height * rows);
  for (int p = 0; p < columns * rows; ++p) {
    const int line = p / columns;
    const double column = p % columns, row = rows - 1 - line;
    vtkNew<vtkRenderer> renderer;
    renderer->SetViewport(column / columns, row / rows, (column + 1) / columns, (row + 1) / rows);
    renderer->SetBackground(1, 1, 1);
    window->AddRenderer(renderer);  // first: the view depends on the panel's shape
    if (p >= count) continue;
    vtkPolyData& filling = subject != nullptr ? *subject : *panels[p].surface;
    fill_panel(*renderer, panels[p], boundary, filling, style);
  }
  window->Render();
  write_png(*window, file);
}

}  // namespace kappaflow
