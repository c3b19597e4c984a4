// What VTK complains about, caught instead of printed.
#pragma once

#include <vtkLogger.h>
#include <vtkOutputWindow.h>
#include <vtkSmartPointer.h>

#include <string>

namespace kappaflow {

/// As long as it lives, VTK prints nothing. For one thread at a time.
class VtkMessages {
 public:
  VtkMessages();
  ~VtkMessages();
  VtkMessages(const VtkMessages&) = delete;
  VtkMessages& operator=(const VtkMessages&) = delete;

  /// The first error so far, its last line: what is wrong, without VTK's own place. Empty: none.
  const std::string& first_error() const;

 private:
  vtkSmartPointer<vtkOutputWindow> previous_;
  class Window;
  vtkSmartPointer<Window> window_;
  vtkLogger::Verbosity previous_verbosity_;
};

}  // namespace kappaflow
