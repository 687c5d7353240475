// A small job for the tests of this folder: two inputs, parts on one or two trays, curved, hollow
// and turned.
#pragma once

#include "fixtures/models.h"
#include "model/job.h"

namespace packmerger::fixtures {

inline Pose pose_of(const Vec3& axis, double degrees_around, const Vec3& to) {
  Pose pose = Pose::Identity();
  pose.linear() = Eigen::AngleAxisd(radians(degrees_around), axis.normalized()).toRotationMatrix();
  pose.translation() = to;
  return pose;
}

// Turned by the pose's rotation, lowest corner put at `low`.
inline Pose standing_at(const Mesh& mesh, Pose pose, const Vec3& low) {
  pose.translation().setZero();
  pose.translation() = low - bounding_box(transformed(mesh, pose)).min();
  return pose;
}

inline JobPart sample_part(int id, int model, int tray, const TriangleSoup& soup, const Pose& turn,
                           const Vec3& low) {
  JobPart part;
  part.id = id;
  part.model = model;
  part.tray = tray;
  part.surface = closed_mesh(soup);
  part.pose = standing_at(part.surface, turn, low);
  part.volume_mm3 = volume_mm3(part.surface);
  return part;
}

inline Profile sample_profile() {
  Profile profile;
  profile.id = "sample";
  profile.name = "Sample \"printer\"";
  profile.build_mm = {150, 120, 90};
  profile.layer_mm = 0.2;
  profile.support_angle_deg = 45;
  return profile;
}

inline Job sample_job(int trays = 1) {
  Job job;
  job.inputs = {{"ball.stl", std::string(64, 'a'), 1},
                {"box \xc3\xa9.obj", std::string(64, 'b'), 25.4}};
  job.models = {closed_mesh(sphere(25, 4)), closed_mesh(nested_cubes(30, 20))};
  job.profile = sample_profile();
  job.seed = 7;
  const Vec3 askew(1, 2, 3);
  job.parts.push_back(sample_part(1, 0, 1, sphere(25, 4), pose_of(askew, 40, {}), {10, 10, 0}));
  job.parts.push_back(
      sample_part(2, 1, 1, nested_cubes(30, 20), pose_of(askew, 33, {}), {70, 10, 0}));
  job.parts.push_back(
      sample_part(3, 0, trays, torus(20, 6, 48, 24), pose_of(Vec3::UnitX(), 90, {}), {60, 70, 0}));
  job.parts.push_back(sample_part(4, 1, trays, box({-5, -5, -5}, {15, 5, 40}),
                                  pose_of(Vec3::UnitY(), 90, {}), {10, 90, 0}));
  job.parts[0].neighbours = {{3, 12.5}};
  job.parts[2].neighbours = {{1, 12.5}};
  job.removal_order = {3, 4, 2, 1};
  job.shell_volume_mm3 = 12345;
  job.estimates.packed = Estimate{3600, 1000, 1.2, 200, 0.2, 12.5, "EUR", 2, 3, 7.5, 4, trays, 3.5};
  job.estimates.solid = Estimate{7200, 2000, 2.4, 400, 0.4, 15, "EUR"};
  job.estimates.solid->source = EstimateSource::kSlicer;
  job.advised = "packed";
  job.advice = "Pack it.";
  job.timings_s = {{"reading", 0.5}, {"packing", 2.5}};
  job.warnings = {{"sealed_cavity", "One cavity of 8000 mm³ traps support"}};
  return job;
}

}  // namespace packmerger::fixtures
