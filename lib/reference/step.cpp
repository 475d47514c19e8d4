#include "reference/step.hpp"

#include <cmath>
#include <sstream>

#include "core/error.hpp"
#include "fields/body_force.hpp"
#include "materials/registry.hpp"
#include "reference/grid_update.hpp"
#include "reference/spline.hpp"

namespace jaxmpm {
namespace {

/// One node of a particle's stencil.
template <class Scalar>
struct Reach {
  Node node;
  Scalar weight;               // φ
  Triple<Scalar> slope;        // ∇φ, 1/m
  Triple<Scalar> offset;       // x_i − x_p, m
  Triple<Scalar> force_slope;  // g of the internal force and the material's ∇v, 1/m
};

/// D of the quadratic and cubic splines, m².
double moment(const Model& model) { return model.cell_size * model.cell_size / (model.method.basis == deck::Basis::quadratic ? 4 : 3); }

/// Nodes that a particle at X reaches: φ is the product over axes (Eq 6).
template <class Scalar>
std::vector<Reach<Scalar>> stencil(const Model& model, const Triple<Scalar>& X) {
  const deck::Basis basis = model.method.basis;
  const int support = spline_support(basis);
  const double h = model.cell_size;
  Node base{};
  for (int a = 0; a < model.dim; ++a) base[a] = spline_base(basis, value_of(X[a]));
  std::vector<Reach<Scalar>> reach;
  for (int k = 0; k < (model.dim == 3 ? support : 1); ++k)
    for (int j = 0; j < support; ++j)
      for (int i = 0; i < support; ++i) {
        Reach<Scalar> r{{base[0] + i, base[1] + j, base[2] + k}, Scalar(1), {}, {}, {}};
        const Node unwrapped = r.node;
        for (int a = 0; a < model.dim; ++a)
          if (model.is_periodic(a)) r.node[a] = ((unwrapped[a] % model.cells[a]) + model.cells[a]) % model.cells[a];
        for (int a = 0; a < model.dim; ++a) {
          const Scalar xi = X[a] - Scalar(unwrapped[a]);
          r.weight *= spline(basis, xi);
          r.offset[a] = -xi * Scalar(h);
          r.slope[a] = spline_slope(basis, xi) / Scalar(h);
          for (int b = 0; b < model.dim; ++b)
            if (b != a) r.slope[a] *= spline(basis, X[b] - Scalar(unwrapped[b]));
        }
        for (int a = 0; a < model.dim; ++a)
          r.force_slope[a] =
              model.method.gradient == deck::GradientForm::spline ? r.slope[a] : r.weight * r.offset[a] / Scalar(moment(model));
        reach.push_back(r);
      }
  return reach;
}

/// Eqs 10–12, B.1 and B.2.
template <class Scalar>
void particles_to_grid(const Model& model, const ReferenceState<Scalar>& state, ReferenceGrid<Scalar>& grid) {
  for (std::size_t b = 0; b < state.bodies.size(); ++b) {
    const ReferenceBody<Scalar>& body = state.bodies[b];
    const double density = deck::reference_density(model.bodies[b].material);
    for (std::size_t p = 0; p < body.mass.size(); ++p) {
      const std::array<Scalar, 6> s = reference_stress(model, state, b, p);
      const Scalar sigma[3][3] = {{s[0], s[3], s[5]}, {s[3], s[1], s[4]}, {s[5], s[4], s[2]}};
      const Scalar m = body.mass[p];
      const Scalar volume = m / (Scalar(density) * (Scalar(1) + body.compression[p]));
      for (const Reach<Scalar>& r : stencil(model, body.position[p])) {
        ReferenceNode<Scalar>& node = grid[r.node];
        node.mass += m * r.weight;
        node.dilation += m * r.weight * body.dilation[p];
        for (int c = 0; c < model.dim; ++c) {
          Scalar v = body.velocity[p][c];
          for (int a = 0; a < model.dim; ++a) {
            v += body.affine[p][c][a] * r.offset[a];
            node.force[c] -= volume * sigma[c][a] * r.force_slope[a];
          }
          node.momentum[c] += m * r.weight * v;
        }
      }
    }
  }
}

/// Eqs 9, 13, 14.
template <class Scalar>
void predict(const Model& model, const Scalar& dt, double time, ReferenceGrid<Scalar>& grid) {
  const Scalar undamped = Scalar(1) / (Scalar(1) + Scalar(model.method.damping) * dt);
  for (auto& [index, node] : grid) {
    Point place{}, b{};
    for (int d = 0; d < model.dim; ++d) place[d] = model.domain_min[d] + model.cell_size * index[d];
    if (model.body_force) b = BodyForce::Loan(*model.body_force).at(place, time);
    for (int c = 0; c < model.dim; ++c)
      node.predicted[c] = undamped * (node.momentum[c] + dt * (node.force[c] + node.mass * Scalar(model.gravity[c] + b[c])));
  }
}

template <class Scalar>
Scalar largest_mass(const ReferenceState<Scalar>& state) {
  Scalar largest(0);
  for (const ReferenceBody<Scalar>& body : state.bodies)
    for (const Scalar& m : body.mass) largest = max(largest, m);
  return largest;
}

/// From sums of changes of volume to their means.
template <class Scalar>
void average_dilation(const Scalar& mass_cutoff, ReferenceGrid<Scalar>& grid) {
  for (auto& [index, node] : grid) node.dilation = node.mass > mass_cutoff ? node.dilation / node.mass : Scalar(0);
}

/// A particle that has passed an open face is taken out: it keeps its place there without mass.
template <class Scalar>
void release(const Model& model, ReferenceBody<Scalar>& body, std::size_t p) {
  for (int a = 0; a < model.dim; ++a) {
    const double x = value_of(body.position[p][a]), last = model.cells[a];
    const bool low = x < 0 && model.is_open(a, false), high = x > last && model.is_open(a, true);
    if (!low && !high) continue;
    body.position[p][a] = Scalar(low ? 0 : last), body.mass[p] = Scalar(0), body.velocity[p] = {};
  }
}

/// Closed faces hold a particle that comes to lie a little beyond them.
template <class Scalar>
void hold(const Model& model, Triple<Scalar>& X) {
  for (int a = 0; a < model.dim; ++a) {
    const double x = value_of(X[a]), last = model.cells[a];
    if (model.is_periodic(a)) continue;
    if (x < 0 && x >= -held_within && !model.is_open(a, false)) X[a] = Scalar(0);
    if (x > last && x <= last + held_within && !model.is_open(a, true)) X[a] = Scalar(last);
  }
}

template <class Scalar>
void check_position(const Model& model, const Triple<Scalar>& X, std::size_t body, std::size_t particle) {
  for (int a = 0; a < model.dim; ++a) {
    const double x = value_of(X[a]);
    if (model.is_periodic(a) || (x >= 0 && x <= model.cells[a])) continue;
    std::ostringstream text;
    text << "reference step: particle " << particle << " of body '" << model.bodies[body].name << "' is at " << x << " cells along axis "
         << a << ", outside the domain of " << model.cells[a] << " cells; use a smaller time step";
    throw NumericsError(text.str());
  }
}

/// Eqs 15–18 for one particle.
template <class Scalar>
void grid_to_particle(const Model& model, const ReferenceGrid<Scalar>& grid, const Scalar& dt, ReferenceBody<Scalar>& body, std::size_t p) {
  Triple<Scalar> pic{}, change{};
  body.mean_dilation[p] = Scalar(0);
  std::array<Triple<Scalar>, 3> moment_sum{}, slope_sum{}, gradient{};
  for (const Reach<Scalar>& r : stencil(model, body.position[p])) {
    const ReferenceNode<Scalar>& node = grid.at(r.node);
    body.mean_dilation[p] += r.weight * node.dilation;
    for (int c = 0; c < model.dim; ++c) {
      pic[c] += r.weight * node.velocity[c];
      change[c] += r.weight * node.change[c];
      for (int a = 0; a < model.dim; ++a) {
        moment_sum[c][a] += r.weight * node.velocity[c] * r.offset[a];
        slope_sum[c][a] += node.velocity[c] * r.slope[a];
        gradient[c][a] += node.velocity[c] * r.force_slope[a];
      }
    }
  }
  const deck::Method& method = model.method;
  const bool invert_moment = method.transfer == deck::Transfer::apic && method.basis != deck::Basis::linear;
  const bool affine = method.transfer == deck::Transfer::apic || method.transfer == deck::Transfer::tpic;
  for (int c = 0; c < model.dim; ++c) {
    body.position[p][c] += dt * pic[c] / Scalar(model.cell_size);
    const Scalar flip = body.velocity[p][c] + change[c];
    const double f = method.transfer == deck::Transfer::flip ? method.flip_fraction : 0;
    body.velocity[p][c] = Scalar(f) * flip + Scalar(1 - f) * pic[c];
    for (int a = 0; a < model.dim; ++a)
      body.affine[p][c][a] = !affine ? Scalar(0) : invert_moment ? moment_sum[c][a] / Scalar(moment(model)) : slope_sum[c][a];
  }
  body.velocity_gradient[p] = gradient;
}

/// The materials advance with H = Δt ∇v, in which a part of the last step's change of volume gives way to its mean.
template <class Scalar, int Dim>
void update_stress(const Model& model, const Scalar& dt, std::size_t b, ReferenceBody<Scalar>& body, ReferenceReport<Scalar>& report) {
  with_law<Scalar>(model.bodies[b].material, [&](const auto& law) {
    using Law = std::decay_t<decltype(law)>;
    for (std::size_t p = 0; p < body.mass.size(); ++p) {
      Matrix<Scalar, Dim> H;
      for (int i = 0; i < Dim; ++i)
        for (int j = 0; j < Dim; ++j) H(i, j) = dt * body.velocity_gradient[p][i][j];
      const Scalar dilation = trace(H), share = Scalar(model.method.volume_averaging / Dim) * (body.mean_dilation[p] - body.dilation[p]);
      for (int i = 0; i < Dim; ++i) H(i, i) = H(i, i) + share;
      body.dilation[p] = dilation;
      const Scalar density = law.template update<Scalar, Dim>(H, dt, body.compression[p], body.history[p].data());
      const Scalar energy = density * body.mass[p] / (law.density * (Scalar(1) + body.compression[p]));
      (Law::template plastic_strain_index<Dim>() < 0 ? report.viscous : report.plastic) += energy;
    }
  });
}

template <class Scalar, int Dim>
void start_history(const Model& model, std::size_t b, ReferenceBody<Scalar>& body) {
  const BodyState& initial = model.bodies[b].initial;
  with_law<Scalar>(model.bodies[b].material, [&](const auto& law) {
    using Law = std::decay_t<decltype(law)>;
    for (std::size_t p = 0; p < body.mass.size(); ++p) {
      Symmetric<Scalar, Dim> stress{};
      if (!initial.stress.empty())
        for (int k = 0; k < stress.size; ++k) stress[k] = Scalar(initial.stress[p][k]);
      body.history[p].assign(Law::template history_size<Dim>(), Scalar(0));
      law.template start<Scalar, Dim>(stress, body.compression[p], body.history[p].data());
    }
  });
}

template <class Scalar, int Dim>
std::array<Scalar, 6> stress_of(const deck::Material& material, const Scalar& compression, const std::vector<Scalar>& history) {
  std::array<Scalar, 6> all{};
  with_law<Scalar>(material, [&](const auto& law) {
    const Symmetric<Scalar, Dim> sigma = law.template stress<Scalar, Dim>(compression, history.data());
    for (int k = 0; k < sigma.size; ++k) all[k] = sigma[k];
  });
  return all;
}

}  // namespace

template <class Scalar>
ReferenceState<Scalar> reference_state(const Model& model) {
  ReferenceState<Scalar> state;
  for (std::size_t b = 0; b < model.bodies.size(); ++b) {
    const BodyState& initial = model.bodies[b].initial;
    const std::size_t count = initial.mass.size();
    ReferenceBody<Scalar> body;
    for (const Point& x : initial.position) body.position.push_back({Scalar(x[0]), Scalar(x[1]), Scalar(x[2])});
    for (const Point& v : initial.velocity) body.velocity.push_back({Scalar(v[0]), Scalar(v[1]), Scalar(v[2])});
    body.mass.assign(initial.mass.begin(), initial.mass.end());
    body.compression.assign(initial.compression.begin(), initial.compression.end());
    body.affine.resize(count);
    body.velocity_gradient.resize(count);
    body.dilation.assign(count, Scalar(0)), body.mean_dilation = body.dilation;
    body.history.resize(count);
    model.dim == 2 ? start_history<Scalar, 2>(model, b, body) : start_history<Scalar, 3>(model, b, body);
    state.bodies.push_back(std::move(body));
  }
  return state;
}

template <class Scalar>
std::array<Scalar, 6> reference_stress(const Model& model, const ReferenceState<Scalar>& state, std::size_t body, std::size_t particle) {
  const ReferenceBody<Scalar>& of = state.bodies[body];
  const deck::Material& material = model.bodies[body].material;
  return model.dim == 2 ? stress_of<Scalar, 2>(material, of.compression[particle], of.history[particle])
                        : stress_of<Scalar, 3>(material, of.compression[particle], of.history[particle]);
}

template <class Scalar>
ReferenceReport<Scalar> reference_step(const Model& model, ReferenceState<Scalar>& state, const Scalar& dt, double time) {
  if (model.method.gradient == deck::GradientForm::mls && model.method.basis == deck::Basis::linear)
    throw DeckError("/method/gradient", "\"mls\" needs a quadratic or cubic basis: the linear one has no invertible moment matrix");
  ReferenceReport<Scalar> report;
  report.obstacle_impulse.resize(model.obstacles.size());
  particles_to_grid(model, state, report.grid);
  const Scalar mass_cutoff = Scalar(1e-20) * largest_mass(state);
  predict(model, dt, time, report.grid);
  average_dilation(mass_cutoff, report.grid);
  ReferenceGridUpdate<Scalar>(model, mass_cutoff, report).run();
  for (std::size_t b = 0; b < state.bodies.size(); ++b) {
    ReferenceBody<Scalar>& body = state.bodies[b];
    for (std::size_t p = 0; p < body.mass.size(); ++p) {
      grid_to_particle(model, report.grid, dt, body, p);
      release(model, body, p);
      hold(model, body.position[p]);
      check_position(model, body.position[p], b, p);
    }
    model.dim == 2 ? update_stress<Scalar, 2>(model, dt, b, body, report) : update_stress<Scalar, 3>(model, dt, b, body, report);
  }
  return report;
}

template ReferenceState<double> reference_state(const Model&);
template ReferenceState<ReferenceDual> reference_state(const Model&);
template std::array<double, 6> reference_stress(const Model&, const ReferenceState<double>&, std::size_t, std::size_t);
template std::array<ReferenceDual, 6> reference_stress(const Model&, const ReferenceState<ReferenceDual>&, std::size_t, std::size_t);
template ReferenceReport<double> reference_step(const Model&, ReferenceState<double>&, const double&, double);
template ReferenceReport<ReferenceDual> reference_step(const Model&, ReferenceState<ReferenceDual>&, const ReferenceDual&, double);

}  // namespace jaxmpm
