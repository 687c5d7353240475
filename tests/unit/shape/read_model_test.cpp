#include "shape/read/read_model.h"

#include <cstdlib>
#include <limits>
#include <map>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck.h>

#include "base/error.h"
#include "fixtures/models.h"
#include "shape/read/soup.h"
#include "shape/read/utf16.h"
#include "unit/shape/written.h"

namespace packmerger {
namespace {

using std::literals::operator""sv;

using testing::ElementsAre;
using testing::HasSubstr;
using written::PlyCoding;

ModelFile read(const std::string& bytes, const std::string& extension = "") {
  return read_model_bytes(bytes, extension, Progress());
}

Error refusal(const std::string& bytes, const std::string& extension = "") {
  try {
    read(bytes, extension);
  } catch (const Error& error) {
    return error;
  }
  ADD_FAILURE() << "was accepted";
  return Error(Fault::kInternal, "", "");
}

void expect_bad_input(const std::string& bytes, const std::string& extension = "") {
  const Error error = refusal(bytes, extension);
  EXPECT_EQ(error.fault(), Fault::kBadInput) << error.what();
  EXPECT_FALSE(error.hint().empty());
}

// Every format's file of the same model.
std::map<std::string, std::pair<std::string, std::string>> all_files(const TriangleSoup& soup) {
  return {{"binary stl", {"stl", written::binary_stl(soup)}},
          {"ascii stl", {"stl", written::ascii_stl(soup, "a name with facet in it")}},
          {"obj", {"obj", written::obj(soup)}},
          {"off", {"off", written::off(soup)}},
          {"ascii ply", {"ply", written::ply(soup, PlyCoding::kAscii)}},
          {"little ply", {"ply", written::ply(soup, PlyCoding::kLittle)}},
          {"big ply", {"ply", written::ply(soup, PlyCoding::kBig)}},
          {"3mf", {"3mf", written::simple_three_mf(soup)}}};
}

TEST(ReadModel, EveryFormatGivesTheSameShape) {
  const TriangleSoup model = fixtures::sphere(10, 2);
  const double volume = signed_volume_mm3(model);
  for (const auto& [name, file] : all_files(model)) {
    SCOPED_TRACE(name);
    const ModelFile found = read(file.second, file.first);
    EXPECT_EQ(found.format, file.first);
    EXPECT_EQ(found.has_unit, file.first == "3mf");
    EXPECT_EQ(found.soup.triangles.size(), model.triangles.size());
    EXPECT_NEAR(signed_volume_mm3(found.soup), volume, 1e-3);
  }
}

TEST(ReadModel, ContentGoesBeforeExtension) {
  const TriangleSoup model = fixtures::cube(10);
  EXPECT_EQ(read(written::binary_stl(model, "solid facet endsolid"), ".obj").format, "stl");
  EXPECT_EQ(read(written::ply(model, PlyCoding::kBig), "STL").format, "ply");
  EXPECT_EQ(read(written::off(model), "obj").format, "off");
  EXPECT_EQ(read(written::simple_three_mf(model), "stl").format, "3mf");
  EXPECT_EQ(read(written::ascii_stl(model, ""), "").format, "stl");
  EXPECT_EQ(read(written::obj(model), ".OBJ").format, "obj");
}

TEST(ReadModel, BinaryStlMayBeginWithSolidAndCarryTrailingBytes) {
  const TriangleSoup model = fixtures::cube(10);
  EXPECT_EQ(read(written::binary_stl(model, "solid ascii"), "stl").soup.triangles.size(), 12u);
  EXPECT_EQ(read(written::binary_stl(model, "made by") + "extra", "stl").soup.triangles.size(),
            12u);
}

TEST(ReadModel, AsciiStlHoldsSeveralSolidsAndAnyLineEnd) {
  const TriangleSoup model = fixtures::cube(10);
  for (const char* end : {"\n", "\r\n", "\r"}) {
    const std::string both =
        written::ascii_stl(model, "first one", end) + written::ascii_stl(model, "", end);
    EXPECT_EQ(read(both, "stl").soup.triangles.size(), 24u);
  }
}

TEST(ReadModel, ObjKnowsNegativeIndicesPolygonsAndContinuedLines) {
  const std::string square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
  EXPECT_EQ(read(square + "f -4 -3 -2 -1\n", "obj").soup.triangles.size(), 2u);
  EXPECT_EQ(read(square + "f 1 2 \\\n 3 4\n", "obj").soup.triangles.size(), 2u);
  EXPECT_EQ(read("\xEF\xBB\xBF# mark\n" + square + "f 1 2 3\n", "obj").soup.triangles.size(), 1u);
  expect_bad_input(square + "f 1 2 5\n", "obj");
  expect_bad_input(square + "f 1 2 0\n", "obj");
  expect_bad_input(square + "f 1 2 -9\n", "obj");
  expect_bad_input(square + "f 1 2 x\n", "obj");
}

TEST(ReadModel, ObjLinesGoOnAfterABackslash) {
  const std::string rest = "v 0 1 0\nv 0 0 1\n";
  for (const char* text : {"v 0 0 0\nv 1 \\\n 0 0\n", "v 0 0 0\nv 1 0\\\n 0\n",
                           "v 0 0 \\\r\n0\r\nv \\  \n1 \\\n0 0 # end\n"})
    for (const char* faces : {"f 1 3 2\\\n 4\n", "f 1\\\n 3 2 4 # a face\n", "f 1 3 2 4\\"})
      EXPECT_EQ(read_model_bytes(text + rest + faces, "obj", Progress()).soup.triangles.size(), 2u)
          << text << faces;
}

TEST(ReadModel, ObjFacesOfOldAndNoFreeFormSurfaces) {
  const std::string points = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
  EXPECT_EQ(read(points + "fo 1 2 3\n", "obj").soup.triangles.size(), 1u);
  EXPECT_THAT(
      refusal(points + "f 1 2 3\ncstype bezier\ndeg 1 1\nsurf 0 1 0 1 1 2 4 3\nend\n", "obj")
          .what(),
      HasSubstr("free-form surfaces (line 8)"));
}

TEST(ReadModel, OffOfThreeCoordinatesOnly) {
  const std::string rest = "\n3 1 0\n0 0 0 1\n1 0 0 1\n0 1 0 1\n3 0 1 2\n";
  EXPECT_EQ(read("STCNOFF" + rest, "off").soup.triangles.size(), 1u);
  for (const char* word : {"4OFF", "nOFF", "C4OFF"})
    EXPECT_THAT(refusal(word + rest, "off").what(), HasSubstr("three coordinates"));
}

TEST(ReadModel, PassesOverAByteOrderMark) {
  const TriangleSoup cube = fixtures::cube(10);
  const std::string mark = "\xEF\xBB\xBF";
  for (const std::string& text : {written::ascii_stl(cube, "x"), written::obj(cube)}) {
    const bool is_obj = text[0] == '#';
    EXPECT_EQ(
        read_model_bytes(mark + text, is_obj ? "obj" : "stl", Progress()).soup.triangles.size(),
        12u);
  }
  EXPECT_EQ(read_model_bytes(mark + "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", "stl", Progress())
                .format,
            "off");
}

TEST(ReadModel, ReadsTextInUtf16) {
  const TriangleSoup cube = fixtures::cube(10);
  const auto wide = [](const std::string& text, bool big_endian) {
    std::string bytes;
    for (const char c : text) written::put(bytes, static_cast<std::uint16_t>(c), big_endian);
    return bytes;
  };
  // A name in Cyrillic, one beyond 16 bits, and half a character.
  const std::u16string name = u"solid \u043A\u0443\u0431 \U0001F9CA\n";
  for (const bool big_endian : {false, true}) {
    const std::string mark = big_endian ? "\xFE\xFF" : "\xFF\xFE";
    std::string title;
    for (const char16_t unit : name) written::put(title, unit, big_endian);
    written::put(title, std::uint16_t{0xD800}, big_endian);
    const std::string stl = written::ascii_stl(cube, "x");
    const std::string facets = wide(stl.substr(stl.find('\n')), big_endian);
    for (const std::string& bytes :
         {mark + title + facets, mark + wide(written::obj(cube), big_endian), wide(stl, big_endian),
          wide(stl, big_endian) + "\n"}) {
      const bool is_obj = bytes.find('#') < 4;
      EXPECT_EQ(read_model_bytes(bytes, is_obj ? "obj" : "", Progress()).soup.triangles.size(),
                12u);
    }
  }
  EXPECT_EQ(utf8_of("\x3E\xD8\xCA\xDD\x3A\x04\x00\xDC?"sv, ByteOrder::kLittle),
            "\xF0\x9F\xA7\x8A\xD0\xBA\xEF\xBF\xBD");
}

TEST(ReadModel, NamesWhatIsNoMesh) {
  const std::string text = written::ascii_stl(fixtures::cube(10), "x");
  const auto told = [](const std::string& bytes) -> std::string {
    try {
      read_model_bytes(bytes, "stl", Progress());
    } catch (const Error& error) {
      EXPECT_EQ(error.fault(), Fault::kBadInput);
      return error.what();
    }
    return "";
  };
  using testing::ElementsAre;
  using testing::HasSubstr;
  EXPECT_THAT(told("\x1F\x8B" + text), HasSubstr("gzip"));
  EXPECT_THAT(told(std::string("\xFF\xFE\0\0s\0\0\0", 8)), HasSubstr("UTF-32"));
  EXPECT_THAT(told("ISO-10303-21;\n"), HasSubstr("STEP"));
  EXPECT_THAT(told(written::zipped({{"cube.stl", text}})), HasSubstr("ZIP archive"));
}

TEST(ReadModel, ConvexPolygonsAreFansFromTheirFirstCorner) {
  const TriangleSoup bent = read("v 0 0 0\nv 1 0 0\nv 1 1 0.3\nv 0 1 0\nf 1 2 3 4\n", ".obj").soup;
  EXPECT_THAT(bent.triangles, ElementsAre(std::array{0, 1, 2}, std::array{0, 2, 3}));
  const TriangleSoup five =
      read("v 0 0 0\nv 2 0 0\nv 3 1 0\nv 1 2 0\nv 0 1 0\nf 3 4 5 1 2\n", ".obj").soup;
  EXPECT_THAT(five.triangles,
              ElementsAre(std::array{2, 3, 4}, std::array{2, 4, 0}, std::array{2, 0, 1}));
}

TEST(ReadModel, ConcavePolygonsAreCutWithoutFolding) {
  // An L: a fan from its first corner would leave the polygon.
  const std::string text = "v 0 2 0\nv 0 0 0\nv 3 0 0\nv 3 1 0\nv 1 1 0\nv 1 2 0\nf 4 5 6 1 2 3\n";
  const TriangleSoup soup = read(text, "obj").soup;
  ASSERT_EQ(soup.triangles.size(), 4u);
  double area = 0;
  for (const auto& [a, b, c] : soup.triangles) {
    const Vec3 normal = (soup.points[b] - soup.points[a]).cross(soup.points[c] - soup.points[a]);
    EXPECT_GE(normal.z(), 0);
    area += normal.norm() / 2;
  }
  EXPECT_NEAR(area, 4, 1e-12);
}

TEST(ReadModel, RefusesWhatHoldsNoModel) {
  expect_bad_input("", "stl");
  expect_bad_input("\n", "stl");
  expect_bad_input("solid empty\nendsolid empty\n", "stl");
  expect_bad_input(written::binary_stl(TriangleSoup()), "stl");
  expect_bad_input("v 0 0 0\n", "obj");
  expect_bad_input("OFF\n0 0 0\n", "off");
  expect_bad_input("hello", "");
  expect_bad_input("hello", "step");
  EXPECT_THAT(refusal("hello", "step").hint(), HasSubstr("STL"));
}

TEST(ReadModel, RefusesNonFiniteAndEnormousCoordinates) {
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), 1e30}) {
    TriangleSoup model = fixtures::cube(10);
    model.points[3].y() = bad;
    for (const auto& [name, file] : all_files(model)) {
      SCOPED_TRACE(name);
      expect_bad_input(file.second, file.first);
    }
  }
}

TEST(ReadModel, RefusesEveryTruncation) {
  for (const auto& [name, file] : all_files(fixtures::cube(10))) {
    SCOPED_TRACE(name);
    // Text formats without a count cannot know that whole lines are missing.
    const bool has_count = name != "obj" && name != "ascii stl";
    // The last bytes of some formats (colours, attributes) are not needed.
    for (std::size_t size = 0; size + 12 < file.second.size(); size += 7) {
      const std::string cut = file.second.substr(0, size);
      if (has_count) {
        expect_bad_input(cut, file.first);
      } else {
        try {
          EXPECT_LE(read(cut, file.first).soup.triangles.size(), 12u);
        } catch (const Error& error) {
          EXPECT_EQ(error.fault(), Fault::kBadInput);
        }
      }
    }
  }
}

TEST(ReadModel, DoesNotBelieveHugeCounts) {
  std::string stl = written::binary_stl(fixtures::cube(10), "made by");
  for (int i = 80; i < 84; ++i) stl[i] = '\xff';
  expect_bad_input(stl, "stl");
  expect_bad_input("OFF\n9000000000000000000 9000000000000000000 0\n0 0 0\n", "off");
  expect_bad_input("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n9000000000000 0 1 2\n", "off");
  for (const char* format : {"ascii", "binary_little_endian"}) {
    const std::string head = std::string("ply\nformat ") + format + " 1.0\n";
    expect_bad_input(head + "element vertex 9000000000000000000\nproperty float x\nend_header\n",
                     "ply");
    expect_bad_input(head + "element nothing 9000000000000000000\nend_header\n", "ply");
    expect_bad_input(head + "element face 1\nproperty list uint int vertex_indices\nend_header\n" +
                         "\xff\xff\xff\xff",
                     "ply");
  }
  expect_bad_input(
      "ply\nformat ascii 1.0\nelement vertex 1\nproperty list float float x\nend_header\n"
      "1e300 1\n",
      "ply");
}

TEST(ReadModel, NamesTheFileAndCanBeInterrupted) {
  const fs::path path = "some/a cube.stl";
  const std::string bytes = written::binary_stl(fixtures::cube(10));
  EXPECT_EQ(read_model(bytes, path, Progress()).soup.triangles.size(), 12u);
  try {
    read_model(bytes.substr(0, 100), path, Progress());
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.fault(), Fault::kBadInput);
    EXPECT_THAT(error.what(), HasSubstr("a cube.stl: "));
  }
  const std::atomic<bool> cancelled{true};
  try {
    read_model(bytes, path, Progress({}, &cancelled));
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.fault(), Fault::kInterrupted);
  }
}

// Whatever bytes come, the answer is a model whose indices hold, or Error{kBadInput}.
void expect_model_or_refusal(const std::string& bytes, const std::string& extension) {
  try {
    const ModelFile file = read(bytes, extension);
    for (const auto& triangle : file.soup.triangles)
      for (const int corner : triangle)
        RC_ASSERT(corner >= 0 && corner < static_cast<int>(file.soup.points.size()));
    for (const Vec3& point : file.soup.points) RC_ASSERT(point.allFinite());
  } catch (const Error& error) {
    RC_ASSERT(error.fault() == Fault::kBadInput);
    RC_ASSERT(!error.hint().empty());
  }
}

TEST(ReadModel, SurvivesMutatedBytes) {
  const auto files = all_files(fixtures::sphere(10, 1));
  RC_ASSERT(rc::check("mutated files are read or refused", [&] {
    const auto& [name, file] = *rc::gen::elementOf(files);
    std::string bytes = file.second;
    const int changes = *rc::gen::inRange(1, 12);
    for (int i = 0; i < changes; ++i) {
      const auto at = *rc::gen::inRange<std::size_t>(0, bytes.size());
      switch (*rc::gen::inRange(0, 4)) {
        case 0:
          bytes[at] = *rc::gen::arbitrary<char>();
          break;
        case 1:
          bytes.erase(at, *rc::gen::inRange<std::size_t>(1, 40));
          break;
        case 2:
          bytes.insert(at, bytes.substr(at / 2, *rc::gen::inRange<std::size_t>(1, 40)));
          break;
        case 3:
          bytes.insert(at, "99999999999");
          break;
      }
      if (bytes.empty()) return;
    }
    expect_model_or_refusal(bytes, file.first);
  }));
}

TEST(ReadModel, SurvivesAnyBytes) {
  RC_ASSERT(rc::check("any bytes are read or refused", [] {
    const std::string start = *rc::gen::element<std::string>(
        "", "ply\nformat ascii 1.0\n", "OFF\n", "solid x\nfacet\n", "PK\x03\x04", "v 1 2 3\nf ");
    const std::string bytes = start + *rc::gen::arbitrary<std::string>();
    expect_model_or_refusal(bytes,
                            *rc::gen::element<std::string>("stl", "obj", "ply", "off", "3mf", ""));
  }));
}

}  // namespace
}  // namespace packmerger
