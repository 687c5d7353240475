// What a slicer's project says that the volumes of its objects are for: PrusaSlicer's
// Slic3r_PE_model.config, Bambu Studio's and OrcaSlicer's model_settings.config, Cura's
// metadata. Internal to the reader of 3MF.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "shape/read/archive_3mf.h"

namespace packmerger {

enum class VolumeRole { kPart, kNegative, kModifier, kSupportHelper };

// Of one object of the archive's root model part.
struct ObjectRoles {
  struct Range {
    std::int64_t first, last;  // triangles of the object's mesh, both included
    VolumeRole role;
  };
  std::vector<Range> ranges;                     // PrusaSlicer's and Slic3r's way
  std::map<std::string, VolumeRole> components;  // Bambu Studio's and OrcaSlicer's, by object id

  VolumeRole of_triangle(std::int64_t triangle) const;
};

// By object id; objects that nothing is told of are missing. Read from the files that PrusaSlicer
// (Metadata/Slic3r_PE_model.config), Bambu Studio and OrcaSlicer (Metadata/model_settings.config)
// put beside the model, from the settings that Cura puts on its objects, and from the volumes that
// Slic3r names in its meshes; other programs' 3MF have none. model: the root of the archive's root
// model part. A role that is not known is refused: it may mean that there is no matter. Throws
// Error{kBadInput}.
std::map<std::string, ObjectRoles> read_volume_roles(Archive3mf& archive,
                                                     const pugi::xml_node& model);

// What Cura's settings on an object or a build item say. Throws Error{kBadInput} as above, and
// where a mould is to be printed instead of the model.
VolumeRole cura_role(const pugi::xml_node& owner, const pugi::xml_node& model);

}  // namespace packmerger
