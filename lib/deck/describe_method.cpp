// Domain, time and method.
#include <cmath>
#include <iomanip>
#include <sstream>

#include "deck/descriptions.hpp"

namespace jaxmpm::deck {
namespace {

/// Largest number of cells along an axis: those of a domain with a rim can be numbered by 63 bits.
constexpr double most_cells = 1048576;
/// The extent must be whole cells to within this part of a cell.
constexpr double whole_cell_tolerance = 1e-6;

void check_axis(const Domain& domain, std::size_t axis, const described::Place& place) {
  using described::shown_number;
  const double extent = domain.max[axis] - domain.min[axis], h = domain.cell_size;
  const std::string item = std::to_string(axis);
  if (!(extent > 0)) {
    place.key("max").item(axis).problem("must be above the same number of min, " + shown_number(domain.min[axis]));
    return;
  }
  const double cells = extent / h, whole = std::round(cells);
  if (whole > most_cells) {
    place.problem("cell_size", "gives " + shown_number(whole) + " cells along axis " + item + "; at most " + shown_number(most_cells) +
                                   " are possible: enlarge the cells or shrink the domain");
  } else if (std::fabs(cells - whole) > whole_cell_tolerance || whole < 1) {
    const double below = std::max(1.0, std::floor(cells)), above = below + 1;
    std::ostringstream text;
    text << std::setprecision(12) << "does not divide the extent " << extent << " of axis " << axis << " into whole cells (" << cells
         << "); nearest cell sizes: " << extent / above << " or " << extent / below << ", nearest extents: " << below * h << " or "
         << above * h;
    place.problem("cell_size", text.str());
  }
}

}  // namespace

described::EnumNames<Transfer> names_of(Transfer) {
  return {{Transfer::pic, "pic"}, {Transfer::flip, "flip"}, {Transfer::apic, "apic"}, {Transfer::tpic, "tpic"}};
}
described::EnumNames<Basis> names_of(Basis) {
  return {{Basis::linear, "linear"}, {Basis::quadratic, "quadratic"}, {Basis::cubic, "cubic"}};
}
described::EnumNames<GradientForm> names_of(GradientForm) { return {{GradientForm::spline, "spline"}, {GradientForm::mls, "mls"}}; }
described::EnumNames<Precision> names_of(Precision) { return {{Precision::f32, "f32"}, {Precision::f64, "f64"}}; }

void describe(Description<Domain>& d) {
  d.is("domain",
       "The box of grid cells that holds everything. The length of `min` and `max`, 2 or 3, is the dimension; 2D is plane strain of unit "
       "thickness.");
  d.required("min", &Domain::min).unit("m").items(2, 3).help("Lower corner.");
  d.required("max", &Domain::max).unit("m").items(2, 3).help("Upper corner. The extent along each axis is whole cells.");
  d.required("cell_size", &Domain::cell_size).unit("m").above(0).help("Edge of a grid cell.");
  d.check({"min", "max", "cell_size"}, [](const Domain& domain, const described::Place& place) {
    if (domain.min.size() != domain.max.size())
      return place.problem(
          "max", "must have as many numbers as min, " + std::to_string(domain.min.size()) + ", found " + std::to_string(domain.max.size()));
    for (std::size_t axis = 0; axis < domain.min.size(); ++axis) check_axis(domain, axis, place);
  });
}

void describe(Description<Time>& d) {
  d.is("time", "How long, and in which steps. Frames and gauges are taken at the first step at or after their time.");
  d.required("end", &Time::end).unit("s").above(0).help("Time at which the run ends; it starts at 0.");
  d.optional("step", &Time::step)
      .unit("s")
      .above(0)
      .word("auto")
      .help("Time step; \"auto\" takes the largest stable one, anew at every step.");
  d.optional("cfl", &Time::cfl)
      .above(0)
      .to(1)
      .when(
          {"step"}, [](const Time& time) { return !time.step; }, "an automatic step")
      .help("Part of a cell that the fastest wave may cross in one step. With linear splines the default is 0.25.");
  d.check({"step", "end"}, [](const Time& time, const described::Place& place) {
    if (time.step && *time.step > time.end)
      place.problem("step", "is longer than the run, " + described::shown_number(time.end) + " s; make it shorter");
  });
}

void describe(Description<Rest>& d) {
  d.is("rest",
       "Material that has come to rest is left out of the step until something moves beside it: a block of the grid (8 cells along each "
       "axis in 2D, 4 in 3D) rests once its material and that of the blocks around it has kept below `speed` for `time` (docs/theory.md, "
       "\"Material at rest\").");
  d.required("speed", &Rest::speed)
      .unit("m/s")
      .above(0)
      .help(
          "Along every axis. What creeps slower than this may be stopped: choose a speed that crosses well below a cell in the time left.");
  d.required("time", &Rest::time)
      .unit("s")
      .above(0)
      .help("How long a block has to be slow: longer than material that turns round, or starts to fall, is.");
}

void describe(Description<Method>& d) {
  d.is("method", "How particles and grid exchange momentum, and in which precision.");
  d.optional("transfer", &Method::transfer).help("Particle-in-cell, fluid-implicit-particle, affine or Taylor particle-in-cell.");
  d.optional("flip_fraction", &Method::flip_fraction)
      .from(0)
      .to(1)
      .when(
          {"transfer"}, [](const Method& method) { return method.transfer == Transfer::flip; }, "transfer \"flip\"")
      .help("Part of the velocity that is carried on by its change (FLIP); the rest is interpolated (PIC).");
  d.optional("basis", &Method::basis).help("B-splines of the grid.");
  d.optional("gradient", &Method::gradient)
      .help("Velocity gradient and internal force from the spline's gradient, or by moving least squares.");
  d.optional("precision", &Method::precision).help("Of particle and grid fields; positions are double always.");
  d.optional("damping", &Method::damping)
      .unit("1/s")
      .from(0)
      .help("Rate ζ at which motion is taken from the grid, m dv/dt = … − ζ m v, to let a scene come to rest (dynamic relaxation).");
  d.optional("volume_averaging", &Method::volume_averaging)
      .from(0)
      .to(1)
      .help(
          "Part of each step's change of volume that is averaged over the nodes around, against noisy pressure and against locking of "
          "nearly incompressible solids (docs/theory.md; measured in validation/pressure); 0 is none. Only with --backend cpu.");
  d.optional("rest", &Method::rest)
      .otherwise("none: every particle moves at every step")
      .help("Only with --backend cpu, and not in gradients.");
  d.check({"basis", "gradient"}, [](const Method& method, const described::Place& place) {
    if (method.basis == Basis::linear && method.gradient == GradientForm::mls)
      place.problem("gradient", "\"mls\" is singular with the linear basis; use \"spline\", or basis \"quadratic\" or \"cubic\"");
  });
}

}  // namespace jaxmpm::deck
