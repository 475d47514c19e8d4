// Bodies and their initial fields.
#include <cmath>

#include "deck/descriptions.hpp"

namespace jaxmpm::deck {
namespace {

/// Particles lie on a cubic lattice: k along each axis of a cell.
void check_particles_per_cell(const Body& body, const described::Place& place) {
  const int dimension = place.reader.dimension();
  if (!body.particles_per_cell || dimension == 0) return;
  const auto power = [dimension](long k) { return dimension == 2 ? k * k : k * k * k; };
  const long k = std::lround(std::pow(*body.particles_per_cell, 1.0 / dimension));
  if (power(k) == *body.particles_per_cell) return;
  const long below = power(k) < *body.particles_per_cell ? k : k - 1;
  place.problem("particles_per_cell", "must be a whole number to the power " + std::to_string(dimension) +
                                          "; nearest: " + (below > 0 ? std::to_string(power(below)) + " or " : std::string()) +
                                          std::to_string(power(below + 1)));
}

bool on_lattice(const Body& body) { return !body.by_points(); }

void check_initial_stress_surface(const Body& body, const described::Place& place) {
  if (body.initial_stress.kind == InitialStress::Kind::none && body.initial_stress.surface)
    place.problem("initial_stress", "a surface has no effect on \"none\"; remove it");
}

}  // namespace

void describe(Description<Mlp>& d) {
  d.is("mlp", "A fully connected network of the coordinates; its weights are drawn from the seed and may be unknowns.");
  d.required("inputs", &Mlp::inputs).choices({"x", "y", "z"}).items(1, 3).distinct().help("Coordinates that enter.");
  d.required("hidden", &Mlp::hidden).from(1).to(4096).items(1, 16).help("Neurons of each hidden layer.");
  d.optional("activation", &Mlp::activation).choices({"relu", "tanh"}).help("Of the hidden layers.");
  d.optional("seed", &Mlp::seed).from(0).help("Of the random initial weights.");
  d.optional("input_center", &Mlp::input_center)
      .unit("m")
      .otherwise("0 for each input", [](Mlp& mlp, const described::Reader&) { mlp.input_center.assign(mlp.inputs.size(), 0.0); })
      .help("Taken from each input. The middle of the body is a good one.");
  d.optional("input_scale", &Mlp::input_scale)
      .otherwise("1 for each input", [](Mlp& mlp, const described::Reader&) { mlp.input_scale.assign(mlp.inputs.size(), 1.0); })
      .help("Factor on each input, after its center is taken away. Inputs between -1 and 1 train best.");
  d.optional("output_scale", &Mlp::output_scale).unit("m/s").help("Factor on the output.");
  d.optional("weights", &Mlp::weights)
      .items(1)
      .absent_when_empty()
      .otherwise("drawn from the seed")
      .help("Layer by layer: the matrix row by row (one row for each output), then the biases. As an inversion finds them.");
  d.check({"inputs", "input_center", "input_scale"}, [](const Mlp& mlp, const described::Place& place) {
    for (const auto& [key, numbers] : {std::pair{"input_center", &mlp.input_center}, std::pair{"input_scale", &mlp.input_scale}})
      if (numbers->size() != mlp.inputs.size())
        place.problem(key, "must have one number for each of inputs, " + std::to_string(mlp.inputs.size()) + ", found " +
                               std::to_string(numbers->size()));
    for (std::size_t i = 0; i < mlp.inputs.size(); ++i)
      if (mlp.inputs[i] == "z" && place.reader.dimension() == 2)
        place.key("inputs").item(i).problem("there is no z in a 2D domain; remove it");
  });
}

void describe(Description<ParticleFile>& d) {
  d.is("particles", "Values at particles from a file.");
  d.required("file", &ParticleFile::file)
      .items(1)
      .help("CSV with the columns id, vx, vy[, vz], one row for each particle of the body; a column time must hold one time.");
}

void describe(Description<SurfacePoint>& d) {
  d.is("surface", "The free surface: the plane through a point, across gravity.");
  d.required("point", &SurfacePoint::point).unit("m").vector().help("A point of the surface.");
}

void describe(Description<Jitter>& d) {
  d.is("jitter", "Random displacement of the particles from their lattice.");
  d.required("fraction", &Jitter::fraction)
      .above(0)
      .to(1)
      .help("Largest displacement along each axis, in parts of half the lattice spacing.");
  d.optional("seed", &Jitter::seed).from(0).help("Of the random numbers.");
}

void describe(Description<Body>& d) {
  d.is("body",
       "A body of one material. Its particles lie on a lattice aligned to the grid, inside if their centre is, unless a file places them; "
       "bodies may not overlap.");
  d.required("name", &Body::name).help("Names its results; unique among bodies.");
  d.required("material", &Body::material).help("Name of a material of the deck.");
  d.required("shape", &Body::shape).help("Where it is at the start.");
  d.optional("particles_per_cell", &Body::particles_per_cell)
      .from(1)
      .to(4096)
      .when(
          {"spacing", "shape"}, [](const Body& body) { return !body.spacing && !body.by_points(); }, "no spacing and no points given")
      .otherwise("4 in 2D, 8 in 3D",
                 [](Body& body, const described::Reader& reader) {
                   if (!body.spacing && !body.by_points()) body.particles_per_cell = 1 << reader.dimension();
                 })
      .help("A square in 2D, a cube in 3D.");
  d.optional("spacing", &Body::spacing)
      .unit("m")
      .above(0)
      .when({"shape"}, on_lattice, "a shape other than points")
      .otherwise("from particles_per_cell")
      .help("Of the lattice, instead of particles_per_cell.");
  d.optional("velocity", &Body::velocity)
      .unit("m/s")
      .otherwise("0",
                 [](Body& body, const described::Reader& reader) {
                   body.velocity = std::vector<Component>(static_cast<std::size_t>(reader.dimension()), 0.0);
                 })
      .help(
          "At the start: per component a number, an expression of x, y, z and the deck's parameters, or a network; or for all of them the "
          "values of a file.");
  d.optional("initial_stress", &Body::initial_stress)
      .help(
          "By depth along gravity below the highest material on the same line, or below `surface`: \"hydrostatic\"; \"geostatic\" with K0 "
          "= ν/(1 − ν); or an object with `kind` or `k0`, and `surface`. Gravity must be along an axis or `surface` given.");
  d.optional("jitter", &Body::jitter)
      .word("none")
      .when({"shape"}, on_lattice, "a shape other than points")
      .help("Random displacement of the particles.");
  d.check({"name"}, [](const Body& body, const described::Place& place) { described::check_name(body.name, place.key("name")); });
  d.check({"particles_per_cell"}, check_particles_per_cell);
  d.check({"initial_stress"}, check_initial_stress_surface);
}

}  // namespace jaxmpm::deck

namespace jaxmpm::described {
namespace {
using deck::InitialStress;
using Kind = InitialStress::Kind;
const std::vector<std::string> stress_words{"none", "hydrostatic", "geostatic"};

Limits one_per_axis() {
  Limits limits;
  limits.length = Limits::Length::dimension;
  limits.unit = "m/s";
  return limits;
}
Limits not_negative() {
  Limits limits;
  limits.from = 0;
  return limits;
}
Json velocity_component_schema(Schema& defs) {
  return {{"anyOf", Json::array({{{"type", "number"}},
                                 {{"type", "string"}, {"minLength", 1}},
                                 only_key_schema("mlp", Codec<deck::Mlp>::schema({}, defs))})}};
}
}  // namespace

void Codec<deck::Component>::read(deck::Component& out, const Place& place, const Limits& limits) {
  if (place.value.is_string()) {
    Limits filled;
    filled.fewest = 1;
    Codec<std::string>::read(out.emplace<std::string>(), place, filled);
  } else if (place.value.is_object()) {
    if (read_only_key(place, {"mlp"}) == 0) Codec<deck::Mlp>::read(out.emplace<deck::Mlp>(), place.key("mlp"), {});
  } else {
    Codec<double>::read(out.emplace<double>(), place, limits);
  }
}
Json Codec<deck::Component>::write(const deck::Component& in, const Limits&) {
  if (const auto* mlp = std::get_if<deck::Mlp>(&in)) return Json{{"mlp", Codec<deck::Mlp>::write(*mlp, {})}};
  if (const auto* text = std::get_if<std::string>(&in)) return *text;
  return std::get<double>(in);
}
Json Codec<deck::Component>::schema(const Limits&, Schema& defs) {
  return defs.reference("velocity_component", [&defs] { return velocity_component_schema(defs); });
}

void Codec<deck::Velocity>::read(deck::Velocity& out, const Place& place, const Limits&) {
  if (!place.value.is_object())
    return Codec<std::vector<deck::Component>>::read(out.emplace<std::vector<deck::Component>>(), place, one_per_axis());
  if (read_only_key(place, {"particles"}) == 0)
    Codec<deck::ParticleFile>::read(out.emplace<deck::ParticleFile>(), place.key("particles"), {});
}
Json Codec<deck::Velocity>::write(const deck::Velocity& in, const Limits&) {
  if (const auto* file = std::get_if<deck::ParticleFile>(&in)) return Json{{"particles", Codec<deck::ParticleFile>::write(*file, {})}};
  return Codec<std::vector<deck::Component>>::write(std::get<std::vector<deck::Component>>(in), {});
}
Json Codec<deck::Velocity>::schema(const Limits&, Schema& defs) {
  return {{"oneOf", Json::array({Codec<std::vector<deck::Component>>::schema(one_per_axis(), defs),
                                 only_key_schema("particles", Codec<deck::ParticleFile>::schema({}, defs))})}};
}

void Codec<InitialStress>::read(InitialStress& out, const Place& place, const Limits&) {
  if (!place.value.is_object()) {
    const int index = read_choice(place, stress_words);
    if (index >= 0) out.kind = static_cast<Kind>(index);
    return;
  }
  if (place.given("kind") == place.given("k0")) return place.problem("must have exactly one of kind (hydrostatic, geostatic) and k0");
  if (place.given("k0")) {
    out.kind = Kind::k0;
    Codec<double>::read(out.k0, place.key("k0"), not_negative());
  } else {
    const int index = read_choice(place.key("kind"), {"hydrostatic", "geostatic"});
    if (index >= 0) out.kind = static_cast<Kind>(index + 1);
  }
  if (place.given("surface")) Codec<deck::SurfacePoint>::read(out.surface.emplace(), place.key("surface"), {});
  check_keys(place, {"kind", "k0", "surface"});
}
Json Codec<InitialStress>::write(const InitialStress& in, const Limits&) {
  if (in.kind != Kind::k0 && !in.surface) return stress_words[static_cast<std::size_t>(in.kind)];
  Json object = in.kind == Kind::k0 ? Json{{"k0", in.k0}} : Json{{"kind", stress_words[static_cast<std::size_t>(in.kind)]}};
  if (in.surface) object["surface"] = Codec<deck::SurfacePoint>::write(*in.surface, {});
  return object;
}
Json Codec<InitialStress>::schema(const Limits&, Schema& defs) {
  const auto form = [&defs](const std::string& name, Json value) {
    return Json{{"type", "object"},
                {"properties", {{name, std::move(value)}, {"surface", Codec<deck::SurfacePoint>::schema({}, defs)}}},
                {"required", Json::array({name})},
                {"additionalProperties", false}};
  };
  return {{"oneOf", Json::array({{{"enum", stress_words}},
                                 form("kind", {{"enum", {"hydrostatic", "geostatic"}}}),
                                 form("k0", Codec<double>::schema(not_negative(), defs))})}};
}
}  // namespace jaxmpm::described
