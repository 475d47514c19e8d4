#pragma once
// The deck as plain structs: what `read_deck` returns and what everything above it reads. SI units, angles in degrees.
// Optional keys that were not given are empty optionals or hold their default. Ranges, units and documentation are in the describe()
// functions.
#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace jaxmpm::deck {

using Numbers = std::vector<double>;

struct Domain {
  Numbers min, max;
  double cell_size = 0;
};
struct Time {
  double end = 0;
  std::optional<double> step; /* empty: "auto" */
  double cfl = 0.4;
};

enum class Transfer { pic, flip, apic, tpic };
enum class Basis { linear, quadratic, cubic };
enum class GradientForm { spline, mls };
enum class Precision { f32, f64 };
struct Rest {
  double speed = 0, time = 0;
};
struct Method {
  Transfer transfer = Transfer::apic;
  double flip_fraction = 0.99;
  Basis basis = Basis::quadratic;
  GradientForm gradient = GradientForm::spline;
  Precision precision = Precision::f64;
  double damping = 0;
  double volume_averaging = 0;
  std::optional<Rest> rest;
};

struct Newtonian {
  double density = 0, sound_speed = 0, viscosity = 0;
  std::optional<double> tension_limit;
};
struct DruckerPrager {
  double density = 0, friction_angle = 0;
  std::optional<double> bulk_modulus, youngs_modulus, poisson_ratio;  // exactly two
  double dilation_angle = 0, cohesion = 0, tension_cutoff = 0;
};
struct LinearElastic {
  double density = 0, youngs_modulus = 0, poisson_ratio = 0;
};
struct NeoHookean {
  double density = 0, youngs_modulus = 0, poisson_ratio = 0;
};
using Material = std::variant<Newtonian, DruckerPrager, LinearElastic, NeoHookean>;
/// ρ0 of any material: the deck's own number.
inline const double& reference_density(const Material& material) {
  return std::visit([](const auto& m) -> const double& { return m.density; }, material);
}

struct Shape;
struct Box {
  Numbers min, max;
};
struct Sphere {
  Numbers center;
  double radius = 0;
};
struct Cylinder {
  Numbers from, to;
  double radius = 0;
};
struct Polygon {
  std::vector<Numbers> points;
};
struct Mesh {
  std::string file;
  double scale = 1;
  Numbers offset;
};
struct HeightMap {
  std::string file;
  Numbers offset;
  double vertical_scale = 1;
};
struct AreaFile {
  std::string file;
};
struct Layer {
  HeightMap height_map;
  double thickness = 0;
  std::variant<std::vector<Numbers>, AreaFile> area;
};
struct Points {
  std::string file;
};
struct Union {
  std::vector<Shape> shapes;
};
struct Difference {
  std::vector<Shape> shapes;
};  // exactly two
struct Shape {
  std::variant<Box, Sphere, Cylinder, Polygon, Mesh, HeightMap, Layer, Points, Union, Difference> kind;
};

struct Mlp {
  std::vector<std::string> inputs;
  std::vector<int> hidden;
  std::string activation = "relu";
  std::uint64_t seed = 1;
  Numbers input_center, input_scale;
  double output_scale = 1;
  Numbers weights; /* empty: drawn from the seed */
};
using Formula = std::variant<double, std::string>;         // a number, an expression
using Component = std::variant<double, std::string, Mlp>;  // a number, an expression of x, y, z and parameters, a network
struct ParticleFile {
  std::string file;
};
using Velocity = std::variant<std::vector<Component>, ParticleFile>;  // an empty list: at rest

struct SurfacePoint {
  Numbers point;
};
struct InitialStress {
  enum class Kind { none, hydrostatic, geostatic, k0 } kind = Kind::none;
  double k0 = 0;                        // kind k0
  std::optional<SurfacePoint> surface;  // where gravity is along no axis
};
struct Jitter {
  double fraction = 0;
  std::uint64_t seed = 1;
};
struct Body {
  std::string name, material;
  Shape shape;
  std::optional<int> particles_per_cell;  // k^dim; empty with spacing
  std::optional<double> spacing;
  Velocity velocity;
  InitialStress initial_stress;
  std::optional<Jitter> jitter;
  bool by_points() const { return std::holds_alternative<Points>(shape.kind); }  // its particles lie on no lattice
};

enum class ContactKind { slip, no_slip, separate, friction, periodic, open /* the last two: walls only */ };
struct Segment {
  double to = 0, coefficient = 0;
};
struct Wall {
  ContactKind kind = ContactKind::slip;
  double coefficient = 0;
  std::vector<Segment> segments;
  Numbers velocity;  // along the wall; empty: at rest
};
struct Obstacle {
  std::string name;
  Shape shape;
  ContactKind kind = ContactKind::separate;
  double coefficient = 0;
};

struct FrontGauge {
  std::string body, axis, direction = "+";        // axis: x, y, z or radius (about center)
  std::optional<double> quantile, depth, smooth;  // quantile 0.995 unless depth is given; smooth: cell_size
  bool connected = false;
  Numbers center;  // horizontal coordinates of the axis of the radius; only with axis radius
};
struct RegionMeanGauge {
  std::string field;
  Numbers min, max;
};
struct HeightGauge {
  Numbers at;
};
struct PressureGauge {
  Numbers at;
};
struct ForceGauge {
  std::string obstacle, wall;
};  // exactly one
struct EnergyGauge {};
struct MomentumGauge {};
struct ParticlesGauge {
  std::vector<std::int64_t> ids;
  std::vector<std::string> fields;
};
using Gauge = std::variant<FrontGauge, RegionMeanGauge, HeightGauge, PressureGauge, ForceGauge, EnergyGauge, MomentumGauge, ParticlesGauge>;

struct Output {
  double interval = 0;
  std::string directory;  // out/STEM unless given
  std::optional<double> gauge_interval;
  std::vector<std::string> formats{"hdf5", "vtk"};
  std::optional<std::vector<std::string>> fields;
  double checkpoint_interval_minutes = 10;
};

struct Deck {
  std::string title;
  Domain domain;
  Numbers gravity;
  std::vector<Formula> body_force;  // empty: none
  Time time;
  Method method;
  std::map<std::string, double> parameters;
  std::map<std::string, Material> materials;
  std::vector<Body> bodies;
  std::map<std::string, Wall> walls;  // x_min … z_max; a face not named is slip
  std::vector<Obstacle> obstacles;
  std::map<std::string, Gauge> gauges;
  Output output;
  std::string inverse;  // JSON text of /inverse, read by invert and gradient; empty when absent

  std::string path;      // of the deck; relative files are looked for beside it
  std::string as_given;  // text of the file
  std::string resolved;  // JSON text with every default filled in and every --set applied
  int dimension() const { return static_cast<int>(domain.min.size()); }
};

/// Reads, applies `--set` assignments ("/pointer=JSON") and checks a deck. Throws DeckError with every problem at once, IoError if
/// unreadable.
Deck read_deck(const std::string& path, const std::vector<std::string>& assignments = {});

/// The same deck with some values changed, read and checked anew; nothing is read from the file again. Throws DeckError.
Deck with_assignments(const Deck& deck, const std::vector<std::string>& assignments);

/// JSON Schema (draft 2020-12) of the deck, and its reference in Markdown; both from the same describe() functions as the reader.
std::string schema();
std::string reference_page();

/// Names of the domain's faces in a dimension, in order: x_min, x_max, …
std::vector<std::string> face_names(int dimension);
/// Names of the particle fields of results.
const std::vector<std::string>& field_names();
/// The axis along which heights are measured: that of gravity's largest component, the last one where there is no gravity.
std::size_t up_axis(const Numbers& gravity);

}  // namespace jaxmpm::deck
