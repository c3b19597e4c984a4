#include "tools/io/pvd.h"

#include <gtest/gtest.h>
#include <vtkSmartPointer.h>
#include <vtkXMLDataElement.h>
#include <vtkXMLDataParser.h>

#include <cstdlib>
#include <sstream>

namespace kappaflow {
namespace {

TEST(Pvd, IsXmlThatNamesEveryFileAndTime) {
  const std::vector<PvdEntry> entries{{0, 0, "particles", "particles/particles_0000.vtp"},
                                      {0.04, 1, "surface-total", "surface-total/surface_0001.vtp"},
                                      {1.0 / 3.0, 0, "particles", "particles/particles_0002.vtp"}};
  std::istringstream text(pvd_text(entries));
  auto parser = vtkSmartPointer<vtkXMLDataParser>::New();
  parser->SetStream(&text);
  ASSERT_EQ(parser->Parse(), 1);
  vtkXMLDataElement* root = parser->GetRootElement();
  EXPECT_STREQ(root->GetAttribute("type"), "Collection");
  vtkXMLDataElement* collection = root->FindNestedElementWithName("Collection");
  ASSERT_NE(collection, nullptr);
  ASSERT_EQ(collection->GetNumberOfNestedElements(), 3);
  for (int e = 0; e < 3; ++e) {
    vtkXMLDataElement& set = *collection->GetNestedElement(e);
    EXPECT_EQ(std::strtod(set.GetAttribute("timestep"), nullptr), entries[e].time) << "to the last bit";
    EXPECT_EQ(set.GetAttribute("file"), entries[e].file);
    EXPECT_EQ(std::atoi(set.GetAttribute("part")), entries[e].part);
    EXPECT_EQ(set.GetAttribute("name"), entries[e].name);
  }
}

}  // namespace
}  // namespace kappaflow
