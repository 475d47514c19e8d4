#pragma once
// ESRI ASCII grids: a header (ncols, nrows, xllcenter|xllcorner, yllcenter|yllcorner, cellsize, optional NODATA_value), then rows from
// north to south.
#include <string>

#include "fields/surface.hpp"

namespace jaxmpm {

/// Values in the file's coordinates (u: x, v: y), southern row first; missing values are NaN. Throws DeckError (contents) or IoError
/// (unreadable).
Raster read_ascii_grid(const std::string& path, const std::string& pointer);

}  // namespace jaxmpm
