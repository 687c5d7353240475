// What a 3MF file may hold and is not read: refused by name, since what is passed over changes the
// shape. Internal to the reader of 3MF.
#pragma once

#include <string>
#include <string_view>

#include <pugixml.hpp>

namespace packmerger {

// All throw Error{kBadInput}.

// model: a model part's root.
void refuse_required_extensions(const pugi::xml_node& model);

// An object that has neither mesh nor components, holds beams beside its mesh, or is told by
// slices, beside which the mesh may be no more than a box (unless it is called their equal).
void refuse_unread_shapes(const pugi::xml_node& object);

[[noreturn]] void refuse_negative_volume(const std::string& object);

// name: as the slicer's project calls what the volume is for.
[[noreturn]] void refuse_unknown_role(std::string_view name);

[[noreturn]] void refuse_mould(const pugi::xml_node& object);

}  // namespace packmerger
