// Everything a job folder tells: what docs/JOB_FOLDER calls job.json, as plain data.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "model/compared_ways.h"
#include "model/estimate.h"
#include "model/mesh.h"
#include "model/printer.h"
#include "model/warning.h"

namespace packmerger {

struct JobInput {
  std::string file;    // as the user named it, without folders
  std::string sha256;  // of the file's bytes
  double scale = 1;    // file units → mm
};

struct JobNeighbour {
  int id = 0;
  double glue_area_mm2 = 0;
};

struct JobPart {
  int id = 1;                    // from 1; parts/NN.stl
  int model = 0;                 // index into inputs
  int tray = 1;                  // from 1
  Mesh surface;                  // model coordinates, mm
  Pose pose = Pose::Identity();  // model → tray
  double volume_mm3 = 0;
  std::vector<JobNeighbour> neighbours;
};

struct Job {
  std::vector<JobInput> inputs;
  std::vector<Mesh> models;  // the inputs' surfaces, model coordinates, mm, for the pictures
  Profile profile;           // as used, --set included
  std::uint64_t seed = 1;
  std::string variant = "packed";  // packed, hollow or solid: what is prepared to be printed
  std::string advised;             // which of these is best; empty: it fits in no way
  std::string advice;              // the same for people, a sentence

  double shell_volume_mm3 = 0;
  int tetrahedra = 0;
  int clusters = 0;
  int after_premerge = 0;
  int final_segments = 0;

  double cost = 0;         // of the packing, by the profile's objective
  double bbox_mm3 = 0;     // V_bp, summed over the trays
  double support_mm3 = 0;  // V_s on the exact meshes, summed over the trays
  double height_mm = 0;    // of the tallest tray

  std::vector<JobPart> parts;                      // by id
  std::vector<int> removal_order;                  // part ids, first taken out first
  std::map<int, std::vector<Vec3>> removal_paths;  // only parts that are not lifted straight up
  std::optional<double> resample_tolerance_mm;

  Comparison estimates;
  ComparedWays compared;                                  // how they were found
  std::vector<std::pair<std::string, double>> timings_s;  // stage, seconds, in order
  Warnings warnings;
};

}  // namespace packmerger
