// 3MF files as slicers write them, with what they say that volumes are for.
#include <string>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "fixtures/models.h"
#include "shape/read/read_model.h"
#include "shape/read/soup.h"
#include "unit/shape/read_3mf.h"

namespace packmerger {
namespace {

using testing::HasSubstr;
using written::cube_object;
using written::mesh_xml;
using written::read;
using written::refusal;
using written::three_mf;

// Two unit cubes in one mesh, 5 mm apart, and the settings beside them.
std::string project(const std::string& settings, const std::string& second) {
  TriangleSoup both = fixtures::cube(1);
  TriangleSoup other = fixtures::cube(1);
  for (Vec3& point : other.points) point.x() += 5;
  append(both, other);
  const std::string model = "<model><resources><object id=\"3\">" + mesh_xml(both) +
                            "</object></resources><build><item objectid=\"3\"/></build></model>";
  return written::zipped({{"3D/3dmodel.model", model},
                          {settings,
                           "<config><object id=\"3\"><volume firstid=\"0\" lastid=\"11\"/>"
                           "<volume firstid=\"12\" lastid=\"23\">" +
                               second + "</volume></object></config>"}});
}

TEST(ReadProject, LeavesOutTheModifiersOfASlic3rProject) {
  for (const bool modifies : {false, true}) {
    TriangleSoup both = fixtures::cube(1);
    append(both, fixtures::cube(2));
    std::string mesh = mesh_xml(both);
    mesh.insert(mesh.find("</mesh>"),
                "<slic3r:volumes><slic3r:volume ts=\"0\" te=\"11\" modifier=\"0\"/>"
                "<slic3r:volume ts=\"12\" te=\"23\" modifier=\"" +
                    std::to_string(static_cast<int>(modifies)) + "\"/></slic3r:volumes>");
    const ModelFile file = read_model_bytes(
        three_mf("", "<object id=\"1\">" + mesh + "</object>", "<item objectid=\"1\"/>"), "",
        Progress());
    EXPECT_EQ(file.soup.triangles.size(), modifies ? 12u : 24u);
    EXPECT_EQ(file.left_out, modifies ? "1 modifier" : "");
  }
}

std::string volume_type(const std::string& type) {
  return "<metadata type=\"volume\" key=\"volume_type\" value=\"" + type + "\"/>";
}

constexpr const char* kPrusa = "Metadata/Slic3r_PE_model.config";

TEST(ReadProject, LeavesOutTheHelpersOfAPrusaSlicerProject) {
  for (const std::string& type :
       {volume_type("ParameterModifier"), volume_type("SupportBlocker"),
        volume_type("SupportEnforcer"), std::string("<metadata key=\"modifier\" value=\"1\"/>")}) {
    const ModelFile file = read_model_bytes(project(kPrusa, type), "", Progress());
    EXPECT_EQ(file.soup.triangles.size(), 12u) << type;
    EXPECT_THAT(file.left_out, HasSubstr("1 ")) << type;
  }
  const ModelFile file =
      read_model_bytes(project(kPrusa, volume_type("ModelPart")), "", Progress());
  EXPECT_EQ(file.soup.triangles.size(), 24u);
  EXPECT_EQ(file.left_out, "");
}

TEST(ReadProject, NeverPrintsANegativeVolume) {
  EXPECT_THAT(refusal(project(kPrusa, volume_type("NegativeVolume"))),
              HasSubstr("negative volume"));
  EXPECT_THAT(refusal(project(kPrusa, volume_type("Wormhole"))), HasSubstr("Wormhole"));
}

// An object of two components, which stand in a part of their own.
std::string bambu_project(const std::string& subtype) {
  const std::string production =
      " requiredextensions=\"p\" "
      "xmlns:p=\"http://schemas.microsoft.com/3dmanufacturing/production/2015/06\"";
  const std::string component = "\" p:path=\"/3D/Objects/object_1.model\"/>";
  return written::zipped(
      {{"3D/3dmodel.model",
        "<model" + production + "><resources><object id=\"8\"><components><component objectid=\"1" +
            component + "<component transform=\"1 0 0 0 1 0 0 0 1 5 0 0\" objectid=\"2" +
            component +
            "</components></object></resources><build><item objectid=\"8\"/></build></model>"},
       {"3D/Objects/object_1.model", "<model unit=\"millimeter\"><resources>" +
                                         cube_object("id=\"1\"") + cube_object("id=\"2\"") +
                                         "</resources></model>"},
       {"Metadata/model_settings.config",
        "<config><object id=\"8\"><part id=\"1\" subtype=\"normal_part\"/><part id=\"2\" "
        "subtype=\"" +
            subtype + "\"/></object></config>"}});
}

TEST(ReadProject, ReadsBambuProjects) {
  EXPECT_NEAR(bounding_box(read(bambu_project("normal_part"))).max().x(), 6, 1e-12);
  for (const char* helper : {"modifier_part", "support_blocker", "support_enforcer"}) {
    const ModelFile file = read_model_bytes(bambu_project(helper), "", Progress());
    EXPECT_EQ(file.soup.triangles.size(), 12u) << helper;
    EXPECT_NE(file.left_out, "") << helper;
  }
  EXPECT_THAT(refusal(bambu_project("negative_part")), HasSubstr("negative volume"));
}

// Two cubes as Cura writes them: a model, on which a second one hangs, so that the model's own mesh
// is a component. Settings are inner XML of the objects.
std::string cura_project(const std::string& of_model, const std::string& of_second,
                         const std::string& name = "cura") {
  return three_mf(
      "unit=\"millimeter\" xmlns:" + name +
          "=\"http://software.ultimaker.com/xml/cura/3mf/2015/10\"",
      "<object id=\"1\" type=\"model\">" + mesh_xml(fixtures::cube(1)) +
          "</object><object id=\"2\" name=\"Eraser\" type=\"model\">" + of_second +
          mesh_xml(fixtures::cube(1)) +
          "</object><object id=\"3\" name=\"bunny.stl\" type=\"model\"><metadatagroup>" + of_model +
          "<metadata name=\"mesh_node_objectid\" preserve=\"true\">1</metadata></metadatagroup>"
          "<components><component objectid=\"1\" transform=\"\"/><component objectid=\"2\" "
          "transform=\"1 0 0 0 1 0 0 0 1 5 0 0\"/></components></object>",
      "<item objectid=\"3\" transform=\"1 0 0 0 1 0 0 0 1 0 0 0\"/>");
}

std::string cura_setting(const std::string& name, const std::string& value = "True") {
  return "<metadata name=\"" + name + "\">" + value + "</metadata>";
}

std::string group(const std::string& settings) {
  return "<metadatagroup>" + settings + "</metadatagroup>";
}

TEST(ReadProject, LeavesOutTheHelpersOfACuraProject) {
  for (const auto& [name, told] : {std::pair{"anti_overhang_mesh", "1 support blocker or enforcer"},
                                   {"support_mesh", "1 support blocker or enforcer"},
                                   {"infill_mesh", "1 modifier"},
                                   {"cutting_mesh", "1 modifier"}}) {
    const std::string setting = cura_setting("cura:" + std::string(name));
    for (const std::string& bytes :
         {cura_project("", group(cura_setting("cura:infill_sparse_density", "100") + setting)),
          cura_project("", group(cura_setting("c:" + std::string(name))), "c"),
          cura_project("", "<settings><setting key=\"" + std::string(name) +
                               "\">True</setting></settings>")}) {
      const ModelFile file = read_model_bytes(bytes, "", Progress());
      EXPECT_EQ(file.soup.triangles.size(), 12u) << name;
      EXPECT_EQ(file.left_out, told);
    }
    // The model's own settings are for its own mesh alone.
    const ModelFile own = read_model_bytes(cura_project(setting, ""), "", Progress());
    EXPECT_EQ(own.soup.triangles.size(), 12u) << name;
    EXPECT_EQ(own.left_out, told);
    EXPECT_THAT(refusal(cura_project(setting, group(setting))), HasSubstr("nothing to print"));
    // An item's settings count as well.
    EXPECT_THAT(refusal(three_mf("", cube_object("id=\"1\""),
                                 "<item objectid=\"1\">" + group(setting) + "</item>")),
                HasSubstr("nothing to print"));
  }
}

TEST(ReadProject, PrintsWhatACuraProjectPrints) {
  const std::string settings =
      cura_setting("cura:anti_overhang_mesh", "False") + cura_setting("cura:support_enable") +
      cura_setting("cura:infill_mesh_order", "1") + cura_setting("other:support_mesh") +
      cura_setting("cura:extruder_nr", "0") + cura_setting("cura:drop_to_buildplate");
  const ModelFile file = read_model_bytes(cura_project(settings, group(settings)), "", Progress());
  EXPECT_EQ(file.soup.triangles.size(), 24u);
  EXPECT_EQ(file.left_out, "");
}

TEST(ReadProject, RefusesOfACuraProjectWhatItDoesNotKnow) {
  EXPECT_THAT(refusal(cura_project("", group(cura_setting("cura:wormhole_mesh")))),
              HasSubstr("not known (wormhole_mesh)"));
  EXPECT_THAT(refusal(cura_project("", group(cura_setting("cura:mold_enabled")))),
              HasSubstr("mould of the model Eraser"));
  const std::string grouped = "<object id=\"2\">" + group(cura_setting("cura:support_mesh")) +
                              "<components><component objectid=\"1\"/></components></object>";
  EXPECT_THAT(refusal(three_mf("", cube_object("id=\"1\"") + grouped, "<item objectid=\"2\"/>")),
              HasSubstr("for a group of models"));
}

}  // namespace
}  // namespace packmerger
