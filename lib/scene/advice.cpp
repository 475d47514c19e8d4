#include "scene/advice.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "scene/frame.hpp"

namespace jaxmpm {
namespace {

class Adviser {
 public:
  Adviser(const deck::Deck& deck, const Model& model, const FirstStep& step) : deck_(deck), model_(model), step_(step) {}

  std::vector<std::string> all() {
    about_dimension();
    about_precision();
    about_particles();
    about_sound_speed();
    about_step();
    about_scheme();
    return std::move(said_);
  }

 private:
  void say(const std::string& text) { said_.push_back(text); }

  /// Three dimensions where nothing differs along one axis.
  void about_dimension() {
    if (model_.dim == 2 || !model_.obstacles.empty() || model_.body_force) return;
    for (int axis = 0; axis < 3; ++axis)
      if (is_uniform(axis))
        say(std::string("nothing varies along ") + "xyz"[axis] +
            ": in 2D the same scene gives the same result, 25 times cheaper already with 4 cells across (docs/stability.md, \"Two "
            "dimensions instead of three\")");
  }
  bool is_uniform(int axis) const {
    const auto a = std::size_t(axis);
    for (const FaceLaw& face : {model_.faces[2 * a], model_.faces[2 * a + 1]})
      if (face.kind != deck::ContactKind::slip && face.kind != deck::ContactKind::periodic) return false;
    return model_.gravity[a] == 0 &&
           std::all_of(model_.bodies.begin(), model_.bodies.end(), [&](const Body& b) { return is_uniform(b, a); });
  }
  /// Whether a body's columns along an axis all reach from face to face and move as one.
  bool is_uniform(const Body& body, std::size_t axis) const {
    struct Column {
      std::size_t particles = 0;
      double low = std::numeric_limits<double>::infinity(), high = -low;
      Point velocity{};
    };
    std::map<std::array<std::int64_t, 2>, Column> columns;
    for (std::size_t p = 0; p < body.initial.position.size(); ++p) {
      const Point &X = body.initial.position[p], &v = body.initial.velocity[p];
      constexpr double fine = 1 << 20;
      Column& column = columns[{std::llround(fine * X[(axis + 1) % 3]), std::llround(fine * X[(axis + 2) % 3])}];
      if (column.particles == 0) column.velocity = v;
      if (v != column.velocity || v[axis] != 0) return false;
      ++column.particles, column.low = std::min(column.low, X[axis]), column.high = std::max(column.high, X[axis]);
    }
    const auto full = [&](const auto& entry) {
      const Column& c = entry.second;
      return c.particles == columns.begin()->second.particles && c.low < 1 && c.high > model_.cells[axis] - 1;
    };
    return std::all_of(columns.begin(), columns.end(), full);
  }

  void about_precision() {
    constexpr std::size_t many = 100000;
    std::size_t particles = 0;
    for (const Body& body : model_.bodies) particles += body.initial.id.size();
    if (model_.method.precision == deck::Precision::f32 || particles < many) return;
    say("single precision (/method/precision \"f32\") takes 0.6 of the time in 3D and 0.7 in 2D and gives nothing away in a forward run: a "
        "path over 200,000 steps is 0.06 % off (docs/stability.md, \"Drift of single precision\"; docs/performance.md)");
  }

  void about_particles() {
    for (const deck::Body& body : deck_.bodies) {
      if (body.by_points()) continue;
      const double along = body.spacing ? model_.cell_size / *body.spacing
                                        : std::pow(double(body.particles_per_cell.value_or(1 << model_.dim)), 1.0 / model_.dim);
      constexpr double two = 2 - 1e-6;
      if (along < two)
        say("body '" + body.name + "' has " + number_text(std::pow(along, model_.dim)) +
            " particles per cell: with one, the stress of a moving " + "body is 9 % off, with " + std::to_string(1 << model_.dim) +
            " 2.7 % (quadratic splines; docs/stability.md, \"Cell crossing\")");
    }
  }

  /// Speed that the scene's height and first velocities lead to, m/s.
  double expected_speed() const {
    double height = 0, speed2 = 0, g2 = 0;
    for (const double g : model_.gravity) g2 += g * g;
    const double g = std::sqrt(g2);
    for (const Body& body : model_.bodies)
      for (std::size_t p = 0; p < body.initial.position.size(); ++p) {
        double above = 0, v2 = 0;
        for (std::size_t d = 0; d < std::size_t(model_.dim); ++d) {
          const double X = body.initial.position[p][d];
          if (g > 0) above -= model_.gravity[d] / g * (model_.gravity[d] < 0 ? X : X - model_.cells[d]) * model_.cell_size;
          v2 += body.initial.velocity[p][d] * body.initial.velocity[p][d];
        }
        height = std::max(height, above), speed2 = std::max(speed2, v2);
      }
    return std::sqrt(std::max(speed2, 2 * g * height));
  }
  void about_sound_speed() {
    const double speed = expected_speed();
    if (!(speed > 0)) return;
    for (const auto& [name, material] : deck_.materials) {
      const auto* fluid = std::get_if<deck::Newtonian>(&material);
      if (fluid == nullptr) continue;
      const double ratio = fluid->sound_speed / speed;
      const std::string is = "/materials/" + name + "/sound_speed is " + number_text(std::round(10 * ratio) / 10) + " times the speed of " +
                             number_text(std::round(1000 * speed) / 1000) + " m/s that the height and the first velocities lead to";
      constexpr double few = 7, many = 45;
      if (ratio < few) say(is + ": at five times the fluid is compressed by 2 %, at three by 7 %, at ten by 0.5 %" + sound_evidence);
      if (ratio > many)
        say(is + ": forty times takes 3.8 times as many steps as ten, and moves a dam break's front by 0.4 % of its height" +
            sound_evidence);
    }
  }

  void about_step() {
    const double number = step_.dt / step_.limit;
    constexpr double small = 0.1, linear_limit = 0.3;
    if (model_.time.step && number < small)
      say("the fixed step is " + number_text(std::round(1000 * number) / 1000) + " of what a wave takes to cross a cell; \"auto\" takes " +
          number_text(model_.time.cfl) +
          " of it, so fewer steps, and fewer are better: sixteen times as many "
          "had three to eight times the error at one cell size (docs/validation.md, \"Manufactured solution\")");
    if (model_.method.basis == deck::Basis::linear && number > linear_limit)
      say("with linear splines steps above 0.3 of what a wave takes to cross a cell were unstable in some scenes; set /time/cfl to 0.25 or "
          "leave it out (docs/stability.md, \"Time step against the speed of waves\")");
  }

  void about_scheme() {
    const deck::Method& method = model_.method;
    if (method.basis == deck::Basis::linear)
      say("linear splines: the stress of a body that moves through the grid is 42 % off (quadratic: 2.7 %), and a node that hardly touches "
          "the material can end the run (docs/stability.md, \"Cell crossing\" and \"Tiny nodal masses\")");
    if (method.transfer == deck::Transfer::flip && method.flip_fraction == 1)
      say("flip_fraction 1 keeps 99 % of the particles' noise after 1,000 steps, 0.99 halves it in 69 (docs/stability.md, \"FLIP's noise "
          "and its null space\")");
    const double share =
        method.transfer == deck::Transfer::pic ? 1 : (method.transfer == deck::Transfer::flip ? 1 - method.flip_fraction : 0);
    constexpr double much = 0.05;
    if (share >= much) {
      const double h = model_.cell_size;
      say("the part of PIC in the transfer acts like a kinematic viscosity of about " +
          number_text(rounded(0.25 * share * h * h / step_.dt)) +
          " m²/s (0.25 h²/dt for PIC alone; docs/stability.md, \"Dissipation of PIC and of blends with it\"); apic has 1/50 of PIC's");
    }
  }
  static double rounded(double value) {
    const double unit = std::pow(10.0, std::floor(std::log10(value)) - 1);
    return std::round(value / unit) * unit;
  }

  static constexpr const char* sound_evidence = " (docs/stability.md, \"Sound speed against the speed of the flow\")";
  const deck::Deck& deck_;
  const Model& model_;
  FirstStep step_;
  std::vector<std::string> said_;
};

}  // namespace

std::vector<std::string> advice(const deck::Deck& deck, const Model& model, const FirstStep& step) {
  return Adviser(deck, model, step).all();
}

}  // namespace jaxmpm
