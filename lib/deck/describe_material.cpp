// Materials.
#include <cmath>

#include "deck/descriptions.hpp"

namespace jaxmpm::deck {
namespace {

constexpr double degree = 3.14159265358979323846 / 180;

template <class T>
void describe_elastic(Description<T>& d) {
  d.required("density", &T::density).unit("kg/m³").above(0).help("Density at rest.");
  d.required("youngs_modulus", &T::youngs_modulus).unit("Pa").above(0).help("Young's modulus E.");
  d.required("poisson_ratio", &T::poisson_ratio).above(-1).below(0.5).help("Poisson's ratio ν.");
}

/// Exactly two elastic constants; with K and E, ν = (3K − E)/(6K) must lie in (−1, 1/2), which leaves E < 9K.
void check_elastic_constants(const DruckerPrager& m, const described::Place& place) {
  const int count = int(m.bulk_modulus.has_value()) + int(m.youngs_modulus.has_value()) + int(m.poisson_ratio.has_value());
  if (count != 2)
    return place.problem("give exactly two of bulk_modulus, youngs_modulus and poisson_ratio; found " + std::to_string(count));
  if (!m.poisson_ratio && *m.youngs_modulus >= 9 * *m.bulk_modulus)
    place.problem("youngs_modulus", "must be below nine times bulk_modulus, " + described::shown_number(9 * *m.bulk_modulus) +
                                        ": the shear modulus 3KE/(9K − E) would not be positive");
}

/// The tension cut-off may not pass the apex of the cone, k_φ/q_φ = c / tan φ (Du & He 2025, A.3).
void check_cutoff(const DruckerPrager& m, const described::Place& place) {
  if (m.friction_angle == 0) return;  // no apex
  const double apex = m.cohesion / std::tan(m.friction_angle * degree);
  if (m.tension_cutoff > apex * (1 + 1e-12))
    place.problem("tension_cutoff", "must be at most the apex of the cone, cohesion / tan(friction_angle) = " +
                                        described::shown_number(apex) + " Pa, found " + described::shown_number(m.tension_cutoff));
}

}  // namespace

void describe(Description<Newtonian>& d) {
  d.is("newtonian", "Weakly compressible Newtonian fluid: p = c²(ρ − ρ0), s = 2μ dev d (Du & He 2025, Eqs 19–20).", "material");
  d.required("density", &Newtonian::density).unit("kg/m³").above(0).help("Density at rest, ρ0.");
  d.required("sound_speed", &Newtonian::sound_speed)
      .unit("m/s")
      .above(0)
      .help("Speed of sound c; at least ten times the largest velocity keeps it nearly incompressible.");
  d.optional("viscosity", &Newtonian::viscosity).unit("Pa s").from(0).help("Dynamic viscosity μ.");
  d.optional("tension_limit", &Newtonian::tension_limit)
      .unit("Pa")
      .from(0)
      .word("none")
      .help(
          "Largest tension the fluid bears; a pressure below its negative is cut, and the density with it. Water with a free surface wants "
          "0.");
}

void describe(Description<DruckerPrager>& d) {
  d.is("drucker_prager",
       "Elastic, perfectly plastic soil with a Drucker–Prager cone and a tension cut-off (Du & He 2025, Appendix A). Give two of the three "
       "elastic constants.",
       "material");
  d.required("density", &DruckerPrager::density).unit("kg/m³").above(0).help("Density at rest.");
  d.required("friction_angle", &DruckerPrager::friction_angle).unit("°").from(0).below(90).help("Friction angle φ.");
  d.optional("bulk_modulus", &DruckerPrager::bulk_modulus).unit("Pa").above(0).otherwise("from the other two").help("Bulk modulus K.");
  d.optional("youngs_modulus", &DruckerPrager::youngs_modulus)
      .unit("Pa")
      .above(0)
      .otherwise("from the other two")
      .help("Young's modulus E.");
  d.optional("poisson_ratio", &DruckerPrager::poisson_ratio)
      .above(-1)
      .below(0.5)
      .otherwise("from the other two")
      .help("Poisson's ratio ν.");
  d.optional("dilation_angle", &DruckerPrager::dilation_angle)
      .unit("°")
      .from(0)
      .below(90)
      .help("Dilation angle ψ, at most the friction angle.");
  d.optional("cohesion", &DruckerPrager::cohesion).unit("Pa").from(0).help("Cohesion c.");
  d.optional("tension_cutoff", &DruckerPrager::tension_cutoff)
      .unit("Pa")
      .from(0)
      .help("Largest mean tension, at most that of the cone's apex.");
  d.check({"bulk_modulus", "youngs_modulus", "poisson_ratio"}, check_elastic_constants);
  d.check({"friction_angle", "cohesion", "tension_cutoff"}, check_cutoff);
  d.check({"friction_angle", "dilation_angle"}, [](const DruckerPrager& m, const described::Place& place) {
    if (m.dilation_angle > m.friction_angle)
      place.problem("dilation_angle",
                    "must be at most friction_angle, " + described::shown_number(m.friction_angle) + "°: flow would create energy");
  });
}

void describe(Description<LinearElastic>& d) {
  d.is("linear_elastic", "Isotropic linear elasticity with an objective stress rate.", "material");
  describe_elastic(d);
}

void describe(Description<NeoHookean>& d) {
  d.is("neo_hookean", "Compressible neo-Hookean solid for large deformation.", "material");
  describe_elastic(d);
}

}  // namespace jaxmpm::deck

namespace jaxmpm::described {
using Material = Tagged<deck::Material>;
void Codec<deck::Material>::read(deck::Material& out, const Place& place, const Limits&) { Material::read(out, place, "model"); }
Json Codec<deck::Material>::write(const deck::Material& in, const Limits&) { return Material::write(in, "model"); }
Json Codec<deck::Material>::schema(const Limits&, Schema& defs) { return Material::schema(defs, "model"); }
}  // namespace jaxmpm::described
