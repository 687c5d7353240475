#include <string>

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

TEST(Read3mf, UnitHoldsForVerticesAndTranslations) {
  const TriangleSoup soup =
      read(three_mf("unit=\"inch\"", cube_object("id=\"1\""),
                    "<item objectid=\"1\" transform=\"1 0 0 0 1 0 0 0 1 2 0 0\"/>"));
  const Box3 box = bounding_box(soup);
  EXPECT_NEAR(box.min().x(), 50.8, 1e-9);
  EXPECT_NEAR(box.max().x(), 76.2, 1e-9);
  EXPECT_NEAR(box.max().y(), 25.4, 1e-9);
}

TEST(Read3mf, TransformsNestOverComponents) {
  // The component moves by 10 in x, then the item turns x to y: 3MF multiplies rows by matrices.
  const std::string resources = cube_object("id=\"1\"") +
                                "<object id=\"2\"><components><component objectid=\"1\" "
                                "transform=\"1 0 0 0 1 0 0 0 1 10 0 0\"/>"
                                "</components></object>";
  const Box3 box = bounding_box(read(
      three_mf("", resources, "<item objectid=\"2\" transform=\"0 1 0 -1 0 0 0 0 1 0 0 5\"/>")));
  EXPECT_TRUE(box.min().isApprox(Vec3(-1, 10, 5), 1e-9)) << box.min().transpose();
  EXPECT_TRUE(box.max().isApprox(Vec3(0, 11, 6), 1e-9)) << box.max().transpose();
}

TEST(Read3mf, MirroredObjectsStayOutward) {
  const TriangleSoup soup =
      read(three_mf("", cube_object("id=\"1\""),
                    "<item objectid=\"1\" transform=\"-1 0 0 0 1 0 0 0 1 0 0 0\"/>"));
  EXPECT_NEAR(signed_volume_mm3(soup), 1, 1e-12);
}

TEST(Read3mf, LeavesOutSupportAndWhatIsNotPrinted) {
  const std::string resources =
      cube_object("id=\"1\"") + cube_object("id=\"2\" type=\"support\"") + cube_object("id=\"3\"");
  const ModelFile file = read_model_bytes(
      three_mf(
          "", resources,
          "<item objectid=\"1\"/><item objectid=\"2\"/><item objectid=\"3\" printable=\"0\"/>"),
      "", Progress());
  EXPECT_EQ(file.soup.triangles.size(), 12u);
  EXPECT_EQ(file.left_out, "1 support object and 1 item that is not to be printed");
}

TEST(Read3mf, FindsTheModelPartByItsRelationship) {
  EXPECT_EQ(read(three_mf("", cube_object("id=\"1\""), "<item objectid=\"1\"/>", "odd/name.model"))
                .triangles.size(),
            12u);
}

TEST(Read3mf, NamesThatLeaveTheArchiveAreNotThere) {
  const std::string relations =
      "<Relationships><Relationship Target=\"/../../../etc/passwd\" "
      "Type=\"http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel\"/></Relationships>";
  EXPECT_THAT(refusal(written::zipped({{"_rels/.rels", relations}})),
              HasSubstr("no 3D model part"));
}

TEST(Read3mf, RefusesCyclesAndEndlessDoubling) {
  const std::string cycle =
      "<object id=\"1\"><components><component objectid=\"2\"/></components></object>"
      "<object id=\"2\"><components><component objectid=\"1\"/></components></object>";
  EXPECT_THAT(refusal(three_mf("", cycle, "<item objectid=\"1\"/>")), HasSubstr("contains itself"));

  std::string doubling = "<object id=\"0\"><mesh/></object>";
  for (int i = 1; i < 60; ++i) {
    const std::string component = "<component objectid=\"" + std::to_string(i - 1) + "\"/>";
    doubling += "<object id=\"" + std::to_string(i) + "\"><components>" + component + component +
                "</components></object>";
  }
  EXPECT_THAT(refusal(three_mf("", doubling, "<item objectid=\"59\"/>")), HasSubstr("without end"));
}

TEST(Read3mf, RefusesDanglingAndDoubledIds) {
  refusal(three_mf("", cube_object("id=\"1\""), "<item objectid=\"7\"/>"));
  refusal(
      three_mf("", cube_object("id=\"1\"") + cube_object("id=\"1\""), "<item objectid=\"1\"/>"));
}

TEST(Read3mf, RefusesBadTransformsAndUnits) {
  for (const char* transform : {"1 0 0", "1 0 0 0 1 0 0 0 1 0 0 nan", "0 0 0 0 0 0 0 0 0 0 0 0",
                                "a b c d e f g h i j k l", "nan 0 0 0 1 0 0 0 1 0 0 0"})
    refusal(three_mf("", cube_object("id=\"1\""),
                     "<item objectid=\"1\" transform=\"" + std::string(transform) + "\"/>"));
  refusal(three_mf("unit=\"parsec\"", cube_object("id=\"1\""), "<item objectid=\"1\"/>"));
}

TEST(Read3mf, SaysWhichExtensionItDoesNotSupport) {
  EXPECT_THAT(refusal(three_mf("requiredextensions=\"b\" xmlns:b=\"urn:beams\"",
                               cube_object("id=\"1\""), "<item objectid=\"1\"/>")),
              HasSubstr("urn:beams"));
}

TEST(Read3mf, RefusesShapesThatAreMoreThanTheirMesh) {
  const std::string mesh = mesh_xml(fixtures::cube(1));
  const std::string slices = "<slicestack id=\"5\"/><object id=\"1\" s:slicestackid=\"5\" ";
  const std::string beams =
      "<b:beamlattice><b:beams><b:beam v1=\"0\" v2=\"6\"/></b:beams></b:beamlattice></mesh>";
  const auto told = [](const std::string& resources) {
    return refusal(three_mf("", resources, "<item objectid=\"1\"/>"));
  };
  EXPECT_THAT(told(slices + ">" + mesh + "</object>"), HasSubstr("object 1 holds slices"));
  EXPECT_THAT(told(slices + "s:meshresolution=\"lowres\">" + mesh + "</object>"),
              HasSubstr("object 1 holds slices"));
  EXPECT_THAT(
      told("<object id=\"1\">" + mesh.substr(0, mesh.find("</mesh>")) + beams + "</object>"),
      HasSubstr("object 1 holds beams"));
  EXPECT_THAT(told("<object id=\"1\"><v:levelset/></object>"), HasSubstr("<v:levelset>"));
  EXPECT_THAT(told("<object id=\"1\"/>"), HasSubstr("holds no mesh"));
  const std::string full =
      slices + "s:meshresolution=\"fullres\"><metadatagroup/><x:settings/>" + mesh + "</object>";
  EXPECT_EQ(read(three_mf("", full, "<item objectid=\"1\"/>")).triangles.size(), 12u);
}

TEST(Read3mf, NamesWhatIsAmbiguousOrEmpty) {
  const std::string cube = cube_object("id=\"1\"");
  const std::string model =
      "<model><resources>" + cube + "</resources><build><item objectid=\"1\"/></build></model>";
  const auto root = [](const std::string& target) {
    return "<Relationship Target=\"" + target +
           "\" Type=\"http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel\"/>";
  };
  const auto archive = [&](const std::string& other, const std::string& content) {
    return written::zipped({{"_rels/.rels", "<Relationships>" + root("/3D/a.model") + root(other) +
                                                "</Relationships>"},
                            {"3D/a.model", content},
                            {"3D/b.model", content}});
  };
  EXPECT_THAT(refusal(archive("/3D/b.model", model)), HasSubstr("several root models"));
  EXPECT_EQ(read(archive("3D/a.model", model)).triangles.size(), 12u);
  EXPECT_THAT(refusal(archive("3D/a.model", model + model)), HasSubstr("more than one root"));
  EXPECT_THAT(refusal(three_mf("", cube, "")), HasSubstr("build holds nothing to print"));
  EXPECT_THAT(refusal(three_mf("", cube, "<item objectid=\"1\" printable=\"0\"/>")),
              HasSubstr("build holds nothing to print"));
  EXPECT_THAT(
      refusal(three_mf("", cube_object("id=\"1\" type=\"phantom\""), "<item objectid=\"1\"/>")),
      HasSubstr("type that is not known (phantom)"));
}

TEST(Read3mf, PartsThatAreMissingAreRefused) {
  EXPECT_THAT(refusal(three_mf("", cube_object("id=\"1\""),
                               "<item objectid=\"1\" p:path=\"/3D/other.model\"/>")),
              HasSubstr("no 3D model part"));
}

TEST(Read3mf, StopsInflatingABomb) {
  const std::string bomb(std::size_t{64} << 20, ' ');
  EXPECT_THAT(refusal(written::zipped({{"3D/3dmodel.model", bomb}})),
              HasSubstr("implausible size"));
}

}  // namespace
}  // namespace packmerger
