#include "tools/pictures/text_label.h"

#include <vtkTextProperty.h>

namespace kappaflow {

vtkSmartPointer<vtkTextActor> text_label(const std::string& text, double x, double y, int size) {
  auto label = vtkSmartPointer<vtkTextActor>::New();
  label->SetInput(text.c_str());
  vtkTextProperty& look = *label->GetTextProperty();
  look.SetFontSize(size);
  look.SetFontFamilyToArial();
  look.SetColor(0.15, 0.15, 0.18);
  look.SetJustificationToCentered();
  look.SetVerticalJustificationToCentered();
  label->SetPosition(x, y);
  return label;
}

}  // namespace kappaflow
