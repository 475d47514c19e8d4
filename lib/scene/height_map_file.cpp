#include "scene/height_map_file.hpp"

#include <algorithm>
#include <cmath>

#include "core/error.hpp"
#include "fields/ascii_grid.hpp"
#include "fields/files.hpp"

namespace jaxmpm {
namespace {

/// First and last index of the raster's values that a range of `count` cells needs along one axis. The outer half cell has the value of its
/// centre.
std::pair<int, int> needed_range(double origin, double step, int size, int cells) {
  const int first = static_cast<int>(std::floor(-origin / step)), last = static_cast<int>(std::ceil((cells - origin) / step));
  return {std::clamp(first, 0, size - 1), std::clamp(last, 0, size - 1)};
}

void check_extent(double origin, double step, int size, int axis, const Frame& frame, const std::string& pointer) {
  const double lower = origin - 0.5 * step, upper = origin + (size - 0.5) * step, tolerance = 1e-6;
  if (lower <= tolerance && upper >= frame.cells[axis] - tolerance) return;
  const auto metres = [&](double cells) { return number_text(frame.domain_min[axis] + cells * frame.cell_size); };
  throw DeckError(pointer, "the height map covers " + std::string(1, "xyz"[axis]) + " from " + metres(lower) + " to " + metres(upper) +
                               " m (offset applied), but the domain reaches from " + metres(0) + " to " + metres(frame.cells[axis]) +
                               " m; change offset, or make the domain smaller");
}

SurfacePointer load_raster(const deck::HeightMap& map, const Frame& frame, const std::string& pointer) {
  const std::string path = frame.file(map.file);
  const Raster file = read_ascii_grid(path, pointer + "/file");
  const Point offset = height_map_offset(map, frame, pointer);
  const double u0 = frame.coordinate(file.u0 + offset[0], 0), v0 = frame.coordinate(file.v0 + offset[1], 1);
  const double step = file.step / frame.cell_size;
  check_extent(u0, step, file.columns, 0, frame, pointer + "/file");
  check_extent(v0, step, file.rows, 1, frame, pointer + "/file");
  const auto [i0, i1] = needed_range(u0, step, file.columns, frame.cells[0]);
  const auto [j0, j1] = needed_range(v0, step, file.rows, frame.cells[1]);
  Raster used{u0 + i0 * step, v0 + j0 * step, step, i1 - i0 + 1, j1 - j0 + 1, {}};
  used.value.reserve(static_cast<std::size_t>(used.columns) * used.rows);
  for (int j = j0; j <= j1; ++j)
    for (int i = i0; i <= i1; ++i) {
      const double metres = file.at(i, j);
      if (!std::isfinite(metres))
        bad_file(pointer + "/file", path, 0,
                 "the value at x = " + number_text(file.u0 + offset[0] + i * file.step) +
                     ", y = " + number_text(file.v0 + offset[1] + j * file.step) +
                     " m (offset applied) is missing inside the domain's footprint; fill the gap or make the domain smaller");
      used.value.push_back(frame.coordinate(map.vertical_scale * metres + offset[2], 2));
    }
  return make_raster_surface(std::move(used));
}

SurfacePointer load_profile(const deck::HeightMap& map, const Frame& frame, const std::string& pointer) {
  const std::string path = frame.file(map.file);
  const Table table = read_table(path, pointer + "/file");
  if (table.columns.size() != 2) bad_file(pointer + "/file", path, 0, "a profile has two columns: place and height");
  const Point offset = height_map_offset(map, frame, pointer);
  std::vector<double> u, height;
  for (std::size_t r = 0; r < table.rows.size(); ++r) {
    u.push_back(frame.coordinate(table.rows[r][0] + offset[0], 0));
    height.push_back(frame.coordinate(map.vertical_scale * table.rows[r][1] + offset[1], 1));
    if (r > 0 && u[r] <= u[r - 1]) bad_file(pointer + "/file", path, table.lines[r], "places must increase from row to row");
  }
  if (u.size() < 2) bad_file(pointer + "/file", path, 0, "a profile needs at least two points");
  if (u.front() > 1e-6 || u.back() < frame.cells[0] - 1e-6)
    bad_file(pointer + "/file", path, 0,
             "the profile ends inside the domain: it covers x from " + number_text(table.rows.front()[0] + offset[0]) + " to " +
                 number_text(table.rows.back()[0] + offset[0]) + " m (offset applied); change offset, or make the domain smaller");
  return make_profile_surface(std::move(u), std::move(height));
}

}  // namespace

Point height_map_offset(const deck::HeightMap& map, const Frame& frame, const std::string& pointer) {
  Point offset{};
  if (map.offset.empty()) return offset;
  if (static_cast<int>(map.offset.size()) != frame.dim)
    throw DeckError(pointer + "/offset", "give one number for each of the " + std::to_string(frame.dim) + " axes");
  std::copy(map.offset.begin(), map.offset.end(), offset.begin());
  return offset;
}

SurfacePointer load_surface(const deck::HeightMap& map, const Frame& frame, const std::string& pointer) {
  return frame.dim == 3 ? load_raster(map, frame, pointer) : load_profile(map, frame, pointer);
}

}  // namespace jaxmpm
