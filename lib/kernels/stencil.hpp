#pragma once
// The stencils of W particles at once, by dimension (stencil_2d.hpp, stencil_3d.hpp), under common names.
#include "kernels/gather_2d.hpp"
#include "kernels/gather_3d.hpp"

namespace jaxmpm {

template <class Sch, bool Moments, bool Slopes>
using Stencils = std::conditional_t<Sch::Dim == 2, Stencils2d<Sch, Moments, Slopes, false>, Stencils3d<Sch, Moments, Slopes>>;

/// What W particles give, ready for Scatter. Terms: see PlaneTerms.
template <class Sch, class Terms>
using ParticleValues = std::conditional_t<Sch::Dim == 2, Values2d<typename Sch::T, Terms>, Values3d<typename Sch::T, Terms>>;

/// Masses: the first value of a quad is of interest (in 3D all four are, always).
template <class Sch, bool Masses>
using Scatter = std::conditional_t<Sch::Dim == 2, Scatter2d<Sch, Masses>, Scatter3d<Sch>>;
template <class Sch, bool Masses>
using Nodes = std::conditional_t<Sch::Dim == 2, Nodes2d<Sch, Masses>, Nodes3d<Sch>>;
template <class Sch>
using Gather = std::conditional_t<Sch::Dim == 2, Gather2d<Sch>, Gather3d<Sch>>;

}  // namespace jaxmpm
