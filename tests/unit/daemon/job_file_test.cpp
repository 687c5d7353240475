#include "delivery/job_file.h"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include "base/error.h"
#include "delivery/way.h"
#include "fixtures/fault_of.h"
#include "model/files/file_format.h"

namespace packmerger {
namespace {

using fixtures::fault_of;

TEST(JobFile, KindsByTheirEndings) {
  for (const char* name : {"a.stl", "a.STL", "b.obj", "c.ply", "d.off", "e.3mf", "x.gcode.stl"})
    EXPECT_EQ(kind_of_file(name), FileKind::kModel) << name;
  for (const char* name : {"a.gcode", "a.GCODE", "a.gco", "a.g", "m.stl.gcode"})
    EXPECT_EQ(kind_of_file(name), FileKind::kGcode) << name;
  for (const char* name : {"a.x3g", "a.S3G"}) EXPECT_EQ(kind_of_file(name), FileKind::kX3g) << name;
  for (const char* name : {"", "a", "stl", "a.stl.exe", "a.gcode ", "a.toml", "a.bgcode"})
    EXPECT_EQ(kind_of_file(name), FileKind::kUnknown) << name;
  for (const char* name : {"plate.gcode.3mf", "P.GCODE.3MF"})
    EXPECT_EQ(kind_of_file(name), FileKind::kSliced) << name;
  EXPECT_TRUE(is_program("plate.gcode.3mf"));
  EXPECT_TRUE(is_program("a.g"));
  EXPECT_FALSE(is_program("a.stl"));
}

TEST(JobFile, NamesNeverLeadElsewhere) {
  EXPECT_EQ(job_file_name("../../etc/a.gcode"), "a.gcode");
  EXPECT_EQ(job_file_name("C:\\prints\\b.stl"), "b.stl");
  EXPECT_EQ(job_file_name("..hidden.gcode"), "hidden.gcode");
  EXPECT_EQ(job_file_name("a\nb.gcode"), "a_b.gcode");
  EXPECT_EQ(job_file_name("a\u202Eedocg.stl"), "a_edocg.stl") << "shown as gcode.lts turned round";
  for (const char* name : {"", "/", "..", ".stl", "~.gcode", "a/", "../..", "x.exe", "a.gcode/"})
    EXPECT_EQ(fault_of([&] { job_file_name(name); }), Fault::kBadInput) << name;
}

TEST(JobFile, AnyNameBecomesAPlainOne) {
  EXPECT_TRUE(rc::check([](const std::string& bytes) {
    std::string name;
    try {
      name = job_file_name(bytes + ".gcode");
    } catch (const Error&) {
      return;
    }
    RC_ASSERT(name.find('/') == std::string::npos && name.find('\\') == std::string::npos);
    RC_ASSERT(name.size() <= 200U && name.front() != '.' && name.front() != '~');
    RC_ASSERT(name.find('\0') == std::string::npos);
    RC_ASSERT(job_file_name(name) == name);
  }));
}

TEST(JobFile, ALongNameIsNotCutInsideACharacter) {
  for (const std::string character : {"ü", "日", "🐰"})
    for (int ascii = 0; ascii < 4; ++ascii) {
      std::string given;
      while (given.size() < 300) given += character;
      given += std::string(static_cast<std::size_t>(ascii), 'a') + ".gcode";
      const std::string name = job_file_name(given);
      EXPECT_LE(name.size(), 200U);
      EXPECT_GT(name.size(), 200U - character.size());
      EXPECT_TRUE(name.starts_with(character)) << name;
    }
}

TEST(JobFile, PrintersRefuseWhatTheyCannotExecute) {
  const auto fault = [](const Profile& profile, FileKind kind) {
    return fault_of([&] { way_of(profile).check_program(profile, kind); });
  };
  EXPECT_EQ(fault(read_profile("objet30"), FileKind::kGcode), Fault::kBadInput);
  EXPECT_EQ(fault(read_profile("uprint"), FileKind::kX3g), Fault::kBadInput);
  EXPECT_EQ(fault(read_profile("marlin"), FileKind::kX3g), Fault::kBadInput);
  const auto takes = [](const char* id, FileKind kind) {
    const Profile profile = read_profile(id);
    EXPECT_NO_THROW(way_of(profile).check_program(profile, kind)) << id;
  };
  takes("marlin", FileKind::kGcode);
  takes("replicator", FileKind::kX3g);
  takes("replicator", FileKind::kGcode);
  Profile usb = read_profile("objet30");
  usb.dialect = Dialect::kUsb;
  EXPECT_EQ(fault(usb, FileKind::kGcode), Fault::kBadInput);
}

}  // namespace
}  // namespace packmerger
