#pragma once
// Triangles of an STL file, text or binary.
#include <array>
#include <string>
#include <vector>

#include "scene/model.hpp"

namespace jaxmpm {

using Triangle = std::array<Point, 3>;

/// Facets in the file's coordinates; normals in the file are not read (they follow from the order of the corners). `pointer` is that of the
/// file's key. Throws DeckError (contents) or IoError (unreadable).
std::vector<Triangle> read_stl(const std::string& path, const std::string& pointer);

}  // namespace jaxmpm
