#pragma once
// The surface of a height map in lattice coordinates.
#include <memory>
#include <string>

#include "fields/surface.hpp"
#include "scene/frame.hpp"

namespace jaxmpm {

using SurfacePointer = std::shared_ptr<const Surface>;

/// The deck's `offset`, m, zero where it is not given; DeckError unless it has one number per axis.
Point height_map_offset(const deck::HeightMap& map, const Frame& frame, const std::string& pointer);

/// Reads an ESRI ASCII grid (3D) or a profile (2D). Its values must cover the domain's footprint, to whose needs a raster is cut; within
/// the outer half cell of a raster the surface goes on level. `pointer` is that of the height map. Throws DeckError (contents, gaps) or
/// IoError (unreadable).
SurfacePointer load_surface(const deck::HeightMap& map, const Frame& frame, const std::string& pointer);

}  // namespace jaxmpm
