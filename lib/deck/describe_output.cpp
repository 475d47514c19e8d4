// Gauges and output.
#include "deck/descriptions.hpp"

namespace jaxmpm::deck {
namespace {
const char* const family = "gauge";
}

const std::vector<std::string>& field_names() {
  static const std::vector<std::string> names{"position",          "velocity",       "density", "pressure", "stress",
                                              "velocity_gradient", "plastic_strain", "body",    "id"};
  return names;
}

void describe(Description<FrontGauge>& d) {
  d.is("front", "How far a body reaches along an axis: a quantile of its mass, or where it is still `depth` deep.", family);
  d.required("body", &FrontGauge::body).help("Name of a body.");
  d.required("axis", &FrontGauge::axis)
      .choices({"x", "y", "z", "radius"})
      .help("\"radius\" is the distance from the vertical axis through `center`.");
  d.optional("direction", &FrontGauge::direction).choices({"+", "-"}).help("Towards larger or smaller coordinates.");
  d.optional("quantile", &FrontGauge::quantile)
      .above(0)
      .below(1)
      .when(
          {"depth"}, [](const FrontGauge& g) { return !g.depth; }, "no depth given")
      .otherwise("0.995",
                 [](FrontGauge& g, const described::Reader&) {
                   if (!g.depth) g.quantile = 0.995;
                 })
      .help("Part of the mass that lies behind the front.");
  d.optional("depth", &FrontGauge::depth)
      .unit("m")
      .above(0)
      .otherwise("none: by quantile")
      .help(
          "Farthest crossing of this depth of material, instead of a quantile: its volume over the length of the way and, "
          "in 3D, over the domain's breadth. Not along the vertical.");
  d.optional("connected", &FrontGauge::connected).help("Only material joined to the largest cluster of cells.");
  d.optional("smooth", &FrontGauge::smooth)
      .unit("m")
      .from(0)
      .otherwise("cell_size")
      .help("Width over which a particle counts; 0 is hard and no observation.");
  d.optional("center", &FrontGauge::center)
      .unit("m")
      .plan_vector()
      .when(
          {"axis"}, [](const FrontGauge& g) { return g.axis == "radius"; }, "axis \"radius\"")
      .otherwise("required with axis \"radius\"")
      .help("Horizontal coordinates of the vertical axis from which the radius is measured.");
  d.check({"axis", "center"}, [](const FrontGauge& g, const described::Place& place) {
    if (g.axis == "radius" && !place.given("center")) place.problem("center", "is missing: axis \"radius\" needs it");
    if (g.axis == "z" && place.reader.dimension() == 2) place.problem("axis", "there is no z in a 2D domain; choose x, y or radius");
  });
}

void describe(Description<RegionMeanGauge>& d) {
  d.is("region_mean", "Mean of a field over the material in a box.", family);
  d.required("field", &RegionMeanGauge::field)
      .choices({"position", "velocity", "density", "pressure", "stress", "velocity_gradient", "plastic_strain"});
  d.required("min", &RegionMeanGauge::min).unit("m").vector().help("Lower corner of the box.");
  d.required("max", &RegionMeanGauge::max).unit("m").vector().help("Upper corner of the box.");
  d.check({"min", "max"}, [](const RegionMeanGauge& g, const described::Place& place) {
    for (std::size_t i = 0; i < g.min.size() && i < g.max.size(); ++i)
      if (!(g.max[i] > g.min[i]))
        place.key("max").item(i).problem("must be above the same number of min, " + described::shown_number(g.min[i]));
  });
}

void describe(Description<HeightGauge>& d) {
  d.is("height", "Free surface above a point: topmost crossing of volume fraction 0.5 that is connected to the ground.", family);
  d.required("at", &HeightGauge::at).unit("m").plan_vector().help("Horizontal coordinates.");
}

void describe(Description<PressureGauge>& d) {
  d.is("pressure", "Pressure at a point.", family);
  d.required("at", &PressureGauge::at).unit("m").vector();
}

void describe(Description<ForceGauge>& d) {
  d.is("force", "Force of the material on an obstacle or a wall; give one of them.", family);
  d.optional("obstacle", &ForceGauge::obstacle)
      .items(1)
      .when(
          {"obstacle"}, [](const ForceGauge& g) { return !g.obstacle.empty(); }, "an obstacle")
      .otherwise("none")
      .help("Name of an obstacle.");
  d.optional("wall", &ForceGauge::wall)
      .choices(face_names(3))
      .when(
          {"wall"}, [](const ForceGauge& g) { return !g.wall.empty(); }, "a wall")
      .otherwise("none")
      .help("Face of the domain.");
  d.check({"obstacle", "wall"}, [](const ForceGauge& g, const described::Place& place) {
    if (g.obstacle.empty() == g.wall.empty()) place.problem("give exactly one of obstacle and wall");
    if (place.reader.dimension() == 2 && g.wall.rfind('z', 0) == 0)
      place.problem("wall", "there is no z in a 2D domain; choose one of: " + described::listed(face_names(2)));
  });
}

void describe(Description<EnergyGauge>& d) {
  d.is("energy",
       "Kinetic, potential, strain, plastic, viscous, friction and numerical energy; the last is the remainder, and holds the work of "
       "moving walls, of a body force, and of gravity across periodic faces, and what leaves through open ones.",
       family);
}
void describe(Description<MomentumGauge>& d) { d.is("momentum", "Linear momentum of all material.", family); }

void describe(Description<ParticlesGauge>& d) {
  d.is("particles", "Fields of single particles.", family);
  d.required("ids", &ParticlesGauge::ids).from(0).items(1).distinct().help("Of the particles, as in the results.");
  d.required("fields", &ParticlesGauge::fields).choices(field_names()).items(1).distinct();
}

void describe(Description<Output>& d) {
  d.is("output", "What is written, where and how often.");
  d.required("interval", &Output::interval).unit("s").above(0).help("Between frames.");
  d.optional("directory", &Output::directory)
      .items(1)
      .otherwise("out/ and the deck's file name without its ending")
      .help("Of the results; relative names start at the current directory.");
  d.optional("gauge_interval", &Output::gauge_interval)
      .unit("s")
      .above(0)
      .otherwise("interval")
      .help("Between values of gauges; only with gauges.");
  d.optional("formats", &Output::formats).choices({"hdf5", "vtk"}).items(1).distinct();
  d.optional("fields", &Output::fields)
      .choices(field_names())
      .items(1)
      .distinct()
      .otherwise("velocity and the materials' own: pressure (newtonian), stress (elastic), stress and plastic_strain (drucker_prager)")
      .help("Of the frames; position and id are always written.");
  d.optional("checkpoint_interval_minutes", &Output::checkpoint_interval_minutes)
      .unit("min")
      .above(0)
      .help("Of wall-clock time between checkpoints.");
}

}  // namespace jaxmpm::deck

namespace jaxmpm::described {
using Gauge = Tagged<deck::Gauge>;
void Codec<deck::Gauge>::read(deck::Gauge& out, const Place& place, const Limits&) { Gauge::read(out, place, "kind"); }
Json Codec<deck::Gauge>::write(const deck::Gauge& in, const Limits&) { return Gauge::write(in, "kind"); }
Json Codec<deck::Gauge>::schema(const Limits&, Schema& defs) { return Gauge::schema(defs, "kind"); }
}  // namespace jaxmpm::described
