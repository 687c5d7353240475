// The job folder: every file there, right, and nothing there when anything went wrong.
#include "tray/write_job_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>
#include <nlohmann/json.hpp>

#include <atomic>
#include <csignal>
#include <cstdlib>
#include <set>

#include "base/error.h"
#include "model/files/job_folder_names.h"
#include "unit/tray/read_back.h"
#include "unit/tray/sample_job.h"

namespace packmerger {
namespace {

constexpr std::uint64_t kMaxBytes = 64 << 20;

class JobFolder : public testing::Test {
 protected:
  std::set<std::string> names_in(const fs::path& folder) const {
    std::set<std::string> names;
    for (const auto& entry : fs::recursive_directory_iterator(folder))
      if (!entry.is_directory()) names.insert(fs::relative(entry.path(), folder).string());
    return names;
  }
  Fault fault_of(const Job& job, const std::vector<TrayFiles>& trays, const fs::path& out,
                 const Progress& progress = {}) const {
    try {
      write_job_folder(job, trays, out, progress);
    } catch (const Error& error) {
      EXPECT_TRUE(error.fault() == Fault::kInterrupted || !error.hint().empty());
      return error.fault();
    }
    ADD_FAILURE() << "nothing was refused";
    return Fault::kInternal;
  }
  bool nothing_left() const { return fs::is_empty(folder_.path()); }

  TemporaryFolder folder_;
  fs::path out_ = folder_.path() / "job";
};

TEST_F(JobFolder, HoldsEveryFileOfTheContract) {
  write_job_folder(fixtures::sample_job(2), {{"gcode", "G28\n"}, {"gcode", "G28 X\n"}}, out_, {});
  EXPECT_EQ(names_in(out_),
            (std::set<std::string>{"job.json", "profile.toml", "tray.3mf", "tray-2.3mf", "tray.stl",
                                   "tray-2.stl", "parts/01.stl", "parts/02.stl", "parts/03.stl",
                                   "parts/04.stl", "preview.glb", "assembly.glb", "page.glb",
                                   "preview.png", "program.gcode", "program-2.gcode"}));
  for (const std::string& name : names_in(out_))
    EXPECT_TRUE(is_job_file(fs::path(name).filename().string())) << name;
  EXPECT_EQ(read_file(out_ / "program-2.gcode", kMaxBytes), "G28 X\n");
  EXPECT_TRUE(read_file(out_ / "preview.png", kMaxBytes).starts_with("\x89PNG\r\n"));
  EXPECT_EQ(names_in(folder_.path()).size(), 16U) << "nothing beside the folder";
}

TEST_F(JobFolder, ProfileIsTheOneThatJobJsonMeans) {
  write_job_folder(fixtures::sample_job(), {{}}, out_, {});
  const auto json = nlohmann::json::parse(read_file(out_ / "job.json", kMaxBytes));
  EXPECT_EQ(json["profile"]["sha256"], sha256_hex_of_file(out_ / "profile.toml"));
  EXPECT_EQ(read_profile((out_ / "profile.toml").string()).id, json["profile"]["id"]);
}

TEST_F(JobFolder, PartsAndTraysAreClosedAndAgree) {
  const Job job = fixtures::sample_job(2);
  write_job_folder(job, {{}, {}}, out_, {});
  const auto json = nlohmann::json::parse(read_file(out_ / "job.json", kMaxBytes));
  std::map<int, double> tray_volume;
  std::map<int, std::size_t> tray_facets;
  for (const auto& part : json["parts"]) {
    const std::string file = part["file"];
    const auto facets = read_back::stl_facets(read_file(out_ / file, kMaxBytes));
    EXPECT_TRUE(read_back::is_closed(facets)) << file;
    EXPECT_NEAR(read_back::volume(facets), part["volume_mm3"].get<double>(),
                1e-3 * part["volume_mm3"].get<double>());
    tray_volume[part["tray"]] += read_back::volume(facets);
    tray_facets[part["tray"]] += facets.size();

    // The inverse transform puts the part back into the model.
    Eigen::Matrix4d matrix;
    for (int k = 0; k < 16; ++k)
      matrix(k / 4, k % 4) = part["transform"][static_cast<std::size_t>(k)];
    const Mesh& surface = job.parts[part["id"].get<std::size_t>() - 1].surface;
    for (std::size_t f = 0; f < surface.n_triangles(); ++f) {
      const auto expected = surface.corners(f);
      for (int i = 0; i < 3; ++i) {
        const auto& [x, y, z] = facets[f][static_cast<std::size_t>(i)];
        const Vec3 back = (matrix.inverse() * Eigen::Vector4d(x, y, z, 1)).head<3>();
        const auto distance = [&](const Vec3& corner) { return (corner - back).norm(); };
        EXPECT_LT(std::min({distance(expected[0]), distance(expected[1]), distance(expected[2])}),
                  1e-3);
      }
    }
  }
  for (const int tray : {1, 2}) {
    const std::string number = tray == 1 ? "" : "-2";
    const auto facets =
        read_back::stl_facets(read_file(out_ / ("tray" + number + ".stl"), kMaxBytes));
    EXPECT_EQ(facets.size(), tray_facets[tray]);
    EXPECT_TRUE(read_back::is_closed(facets));
    EXPECT_NEAR(read_back::volume(facets), tray_volume[tray], 1e-3 * tray_volume[tray]);
    EXPECT_EQ(
        read_back::objects_3mf(read_file(out_ / ("tray" + number + ".3mf"), kMaxBytes)).size(), 2U);
  }
}

TEST_F(JobFolder, TheSameJobGivesTheSameBytes) {
  write_job_folder(fixtures::sample_job(), {{}}, out_, {});
  write_job_folder(fixtures::sample_job(), {{}}, folder_.path() / "again", {});
  for (const std::string& name : names_in(out_))
    EXPECT_EQ(read_file(out_ / name, kMaxBytes),
              read_file(folder_.path() / "again" / name, kMaxBytes))
        << name;
}

TEST_F(JobFolder, ExistingFoldersAndFilesAreLeftAlone) {
  fs::create_directory(out_);
  EXPECT_EQ(fault_of(fixtures::sample_job(), {{}}, out_), Fault::kCannotWrite);
  EXPECT_TRUE(fs::is_empty(out_));
  fs::remove(out_);
  write_file_whole(out_, "a file");
  EXPECT_EQ(fault_of(fixtures::sample_job(), {{}}, out_), Fault::kCannotWrite);
  EXPECT_EQ(read_file(out_, kMaxBytes), "a file");
  fs::remove(out_);
  fs::create_symlink("nowhere", out_);
  EXPECT_EQ(fault_of(fixtures::sample_job(), {{}}, out_), Fault::kCannotWrite);
  fs::remove(out_);
  EXPECT_TRUE(nothing_left());
}

TEST_F(JobFolder, PlacesThatCannotBeWrittenAreRefused) {
  for (const fs::path& place :
       {folder_.path() / "no/such/job", fs::path("/proc/job"), fs::path("/dev/null/job")})
    EXPECT_EQ(fault_of(fixtures::sample_job(), {{}}, place), Fault::kCannotWrite) << place;
  EXPECT_TRUE(nothing_left());
}

TEST_F(JobFolder, AFailedWriteLeavesNothing) {
  // A program file whose name cannot be made fails after the meshes were written.
  EXPECT_EQ(fault_of(fixtures::sample_job(), {{std::string(300, 'x'), "G28"}}, out_),
            Fault::kCannotWrite);
  EXPECT_TRUE(nothing_left());
  Job broken = fixtures::sample_job();
  broken.parts[3].pose.translation().x() = 1e300;
  EXPECT_EQ(fault_of(broken, {{}}, out_), Fault::kBadInput);
  EXPECT_TRUE(nothing_left());
}

TEST_F(JobFolder, CancellingAtAnyMomentLeavesNothing) {
  for (int stop_at = 0; stop_at < 5; ++stop_at) {
    std::atomic<bool> cancelled{false};
    int reports = 0;
    const Progress progress(
        [&](std::string_view, double) {
          if (reports++ == stop_at) cancelled = true;
        },
        &cancelled);
    try {
      write_job_folder(fixtures::sample_job(2), {{}, {}}, out_, progress);
      EXPECT_TRUE(fs::exists(out_ / "job.json")) << "only the last report may come too late";
      EXPECT_EQ(stop_at, 4);
    } catch (const Error& error) {
      EXPECT_EQ(error.fault(), Fault::kInterrupted);
      EXPECT_TRUE(nothing_left()) << stop_at;
    }
  }
}

// The process that is killed begins anew: one that is only forked lacks the threads that draw the
// pictures, and waits for them for ever.
TEST_F(JobFolder, BeingKilledLeavesNoJobFolder) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  const char* const variable = "JOB_FOLDER_OF_THE_KILLED";
  ::setenv(variable, out_.c_str(), 0);  // the process to be killed is told the folder of this one
  const auto write_and_be_killed = [&] {
    fs::remove(folder_.path());
    const Progress progress(
        [](std::string_view, double fraction) {
          if (fraction > 0.4) ::kill(::getpid(), SIGKILL);
        },
        nullptr);
    write_job_folder(fixtures::sample_job(), {{}}, ::getenv(variable), progress);
  };
  EXPECT_EXIT(write_and_be_killed(), testing::KilledBySignal(SIGKILL), "");
  EXPECT_FALSE(nothing_left()) << "it was killed in the middle";
  EXPECT_FALSE(fs::exists(out_));
  // and what was left behind does not stand in the way of the next try
  write_job_folder(fixtures::sample_job(), {{}}, out_, {});
  EXPECT_TRUE(fs::exists(out_ / "job.json"));
}

TEST_F(JobFolder, JobsThatContradictThemselvesAreBugs) {
  Job job = fixtures::sample_job(2);
  EXPECT_EQ(fault_of(job, {{}}, out_), Fault::kInternal);          // a tray is missing
  EXPECT_EQ(fault_of(job, {{}, {}, {}}, out_), Fault::kInternal);  // a tray is empty
  job.parts[1].id = 1;
  EXPECT_EQ(fault_of(job, {{}, {}}, out_), Fault::kInternal);
  job = fixtures::sample_job();
  job.parts[0].model = 2;
  EXPECT_EQ(fault_of(job, {{}}, out_), Fault::kInternal);
  job.parts.clear();
  EXPECT_EQ(fault_of(job, {}, out_), Fault::kInternal);
  EXPECT_TRUE(nothing_left());
}

}  // namespace
}  // namespace packmerger
