#include "tools/vtk_messages.h"

#include <vtkObjectFactory.h>

#include <string_view>

namespace kappaflow {

class VtkMessages::Window final : public vtkOutputWindow {
 public:
  static Window* New() { VTK_STANDARD_NEW_BODY(Window); }
  void DisplayText(const char* text) override { keep(text); }
  void DisplayErrorText(const char* text) override { keep(text); }
  void DisplayWarningText(const char*) override {}
  // Readers of the legacy format warn where they mean that a file has come to its end too early.
  void DisplayGenericWarningText(const char* text) override { keep(text); }
  void DisplayDebugText(const char*) override {}

  std::string first_error;

 private:
  // "ERROR: In file, line n\nvtkClass (0x...): what is wrong\n\n"
  void keep(std::string_view text) {
    if (!first_error.empty()) return;
    const auto end = text.find_last_not_of(" \n\t");
    if (end == std::string_view::npos) return;
    text = text.substr(0, end + 1);
    if (const auto line = text.rfind('\n'); line != std::string_view::npos) text.remove_prefix(line + 1);
    if (const auto place = text.find("): "); place != std::string_view::npos) text.remove_prefix(place + 3);
    if (const auto file = text.find(" for file: "); file != std::string_view::npos)
      text = text.substr(0, file);
    first_error = text;
  }
};

VtkMessages::VtkMessages()
    : previous_(vtkOutputWindow::GetInstance()),
      window_(vtkSmartPointer<Window>::New()),
      previous_verbosity_(vtkLogger::GetCurrentVerbosityCutoff()) {
  vtkOutputWindow::SetInstance(window_);
  vtkLogger::SetStderrVerbosity(vtkLogger::VERBOSITY_OFF);
}

VtkMessages::~VtkMessages() {
  vtkLogger::SetStderrVerbosity(previous_verbosity_);
  vtkOutputWindow::SetInstance(previous_);
}

const std::string& VtkMessages::first_error() const {
  return window_->first_error;
}

}  // namespace kappaflow
