#pragma once
// What a lattice node inside an obstacle feels of the obstacle's surfaces.
#include <vector>

#include "scene/model.hpp"

namespace jaxmpm {

/// Nodes within this distance of an obstacle's surface count as inside (cells): a face that lies on lattice planes stops the material
/// there.
inline constexpr double obstacle_tolerance = 1e-9;

/// Unit normals, out of the solid, of the surfaces that hold material at a lattice node (in cells); none where the node is outside.
///
/// As a rule that is the nearest surface alone. More than one hold where the node lies behind both sides of a corner of free space, where
/// several are nearest (an edge of the solid on the node), and where the solid is so thin that material on either side reaches the node:
/// it is held from both. What looks like a surface but has solid behind it holds nothing: behind a face of the domain a solid goes on as
/// its mirror image, behind a periodic one as itself, and parts of a union meet. On a face of the domain normals lie in the face: else a
/// slope would push the material out of the domain. A zero where nothing is left of any of them.
std::vector<Point> holding_normals(const RigidObstacle& obstacle, const Point& node, const Model& model);

}  // namespace jaxmpm
