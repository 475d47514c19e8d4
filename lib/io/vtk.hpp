#pragma once
// Frames for ParaView: one .vtp of particles for each frame, one of the obstacles, and a .pvd that gives them physical time.
#include <string>
#include <vector>

#include "io/frame.hpp"
#include "io/index.hpp"

class vtkPolyData;

namespace jaxmpm {

/// Particles as vertices with `id`, `body` (index in deck order) and every field asked for of any body. Throws IoError.
void write_vtk_frame(const std::string& path, const Moment& now, const std::vector<FrameBody>& layout,
                     const std::vector<BodySnapshot>& bodies, int dim);

/// Surfaces (outlines in 2D) as polygons with the array `obstacle` (index in deck order). Throws IoError.
void write_vtk_obstacles(const std::string& path, const deck::Deck& deck, const Model& model);

/// The series: for each frame on disk its time, particles, and the obstacles where there are any. Throws IoError.
void write_vtk_series(const ResultsDirectory& directory, const std::vector<FrameEntry>& frames);

/// Writes poly data as a .vtp (binary, appended). Throws IoError.
void write_polydata(const std::string& path, vtkPolyData* data);

}  // namespace jaxmpm
